#include "penumbra/scene/fluorescence.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "penumbra/scene/emission_spectrum.h"
#include "penumbra/scene/energy.h"
#include "penumbra/scene/lit.h"
#include "penumbra/scene/scene.h"
#include "test_paths.h"

namespace penumbra {
namespace {

Fluorescence dye() {
  return {{360, 420, 500, 600},
          {0.1, 0, 0,    //
           0.2, 0.3, 0,  //
           0.4, 0.1, 0.8}};
}

std::string refusal(const Fluorescence& f) {
  try {
    validate(f);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(Fluorescence, LightGoesToLongerWavelengthsOnly) {
  EXPECT_EQ(refusal(dye()), "");
  Fluorescence wrong = dye();
  wrong.matrix[1] = 1e-6;
  EXPECT_NE(refusal(wrong).find("row 1, column 2"), std::string::npos) << refusal(wrong);
  wrong = dye();
  wrong.matrix[3] = -0.1;
  EXPECT_NE(refusal(wrong).find("0 to 1"), std::string::npos);
  wrong = dye();
  wrong.matrix.pop_back();
  EXPECT_NE(refusal(wrong).find("3 x 3"), std::string::npos);
  wrong = dye();
  wrong.edges[1] = 350;
  EXPECT_NE(refusal(wrong).find("ascending"), std::string::npos);
  // What is sampled was absorbed at shorter wavelengths than those at which it is radiated.
  for (int i = 0; i < 1000; ++i) {
    const double nm = 420 + 180 * (i + 0.5) / 1000;
    const double in = dye().sample_absorbed(nm, std::fmod(i * 0.618, 1.0), std::fmod(i * 0.754, 1.0));
    EXPECT_LT(in, nm < 500 ? 420 : 500);
    EXPECT_GE(in, 360);
  }
  EXPECT_EQ(dye().reradiation(400), 0);
}

// Bands of known widths: D width(in) / width(out).
TEST(Fluorescence, ReradiationIsPowerOverWidths) {
  EXPECT_NEAR(dye().reradiation(450), 0.2 * 60 / 80, 1e-12);
  EXPECT_NEAR(dye().reradiation(550), (0.4 * 60 + 0.1 * 80) / 100, 1e-12);
  int from_first = 0;
  for (int i = 0; i < 1000; ++i) from_first += dye().sample_absorbed(550, (i + 0.5) / 1000, 0.5) < 420 ? 1 : 0;
  EXPECT_NEAR(from_first, 1000 * 24.0 / 32, 1);
}

TEST(Fluorescence, TheEnergyCheckCountsAllThatABandBecomes) {
  Scene scene;
  Material paint;
  paint.specular = 0;
  paint.base_colour = Rgb(0.1F);
  paint.fluorescence = dye();
  scene.materials = {paint};
  EXPECT_NEAR(sent_on(paint).sum(), 0.8F, 1e-6);
  EXPECT_TRUE(materials_beyond_energy(scene).empty());
  scene.materials[0].fluorescence->matrix[0] = 0.6;  // its column: 0.6 + 0.2 + 0.4
  ASSERT_EQ(materials_beyond_energy(scene).size(), 1U);
  fix_energy(scene);
  EXPECT_NEAR(scene.materials[0].fluorescence->largest_column_sum(), 1, 1e-6);
  EXPECT_TRUE(materials_beyond_energy(scene).empty());
}

// The columns of the table's six bands, from an independent computation.
TEST(Fluorescence, ColumnSumsAreThoseOfTheTable) {
  const auto table = nlohmann::json::parse(
      std::ifstream(PENUMBRA_TEST_DATA "/optics_spectrum.json"))["fluorescence"]["furnace_six_band"];
  Fluorescence f;
  f.edges = table["bands_nm"].get<std::vector<double>>();
  f.edges.push_back(740);
  for (const auto& row : table["D"]) {
    for (const double share : row) f.matrix.push_back(share);
  }
  EXPECT_EQ(refusal(f), "");
  for (std::size_t in = 0; in < f.bands(); ++in) {
    EXPECT_NEAR(f.column_sum(in), table["column_sums"][in].get<double>(), 1e-12);
  }
}

TEST(Fluorescence, OnlyMattSurfacesCanFluoresce) {
  Scene scene;
  Material paint;
  paint.fluorescence = dye();
  scene.materials = {paint};
  EXPECT_THROW(validate(scene), std::invalid_argument);  // a specular layer
  scene.materials[0].specular = 0;
  EXPECT_NO_THROW(validate(scene));
}

TEST(EmissionSpectrum, IsEvenWithinItsBandsAndNothingOutside) {
  const EmissionSpectrum lamp{{300, 380, 400}, {8, 1}};
  EXPECT_NO_THROW(validate(lamp));
  EXPECT_NEAR(lamp.at(340), 0.1, 1e-12);
  EXPECT_NEAR(lamp.at(390), 0.05, 1e-12);
  EXPECT_EQ(lamp.at(299), 0);
  EXPECT_EQ(lamp.at(401), 0);
  EXPECT_THROW(validate(EmissionSpectrum{{300, 380}, {-1}}), std::invalid_argument);
  EXPECT_THROW(validate(EmissionSpectrum{{300}, {}}), std::invalid_argument);
}

TEST(EmissionSpectrum, VioletIsBluerThanGreen) {
  const Rgb violet = EmissionSpectrum{{420, 440}, {1}}.colour();
  EXPECT_GT(violet.z, violet.y);
  EXPECT_EQ((EmissionSpectrum{{300, 370}, {1}}.colour()), Rgb(0)) << "ultraviolet is not seen";
}

TEST(EmissionSpectrum, AnUltravioletLampLightsAScene) {
  Scene scene;
  Material lamp;
  lamp.emission_spectrum = EmissionSpectrum{{300, 370}, {1}};
  scene.materials = {lamp};
  scene.shapes = {{"lamp", Sphere{{0, 0, 0}, 1}, 0}};
  EXPECT_TRUE(is_lit(scene));
}

}  // namespace
}  // namespace penumbra
