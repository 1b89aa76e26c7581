#include "penumbra/radiosity/pipeline/spectral_radiosity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "penumbra/scene/builtin_scenes.h"
#include "test_paths.h"

namespace penumbra {
namespace {

constexpr double pi = std::numbers::pi;

RadiositySetupOptions few(std::size_t elements) {
  RadiositySetupOptions options;
  options.element_count = elements;
  options.specular_rays = 0;
  return options;
}

const SolverOptions exact{
    .tolerance = 1e-10, .most_unshot = 1e-10, .stop_at = 1, .max_iterations = 0, .progress = {}, .on_stage = {}};

// What is reflected once from D65 light is the RGB solution; grey light stays so however often.
TEST(SpectralRadiosity, AGreyRoomIsAsInRgb) {
  const Scene scene = make_builtin_scene("furnace?rho=0.6&emission=2");
  const auto setup = make_radiosity_setup(scene, few(300));
  const SpectralRadiosity solved = solve_spectral(scene, *setup, exact);
  const SceneRadiosity rgb = solve(*setup, exact);
  for (std::size_t k = 0; k < rgb.solution.radiosity.size(); ++k) {
    EXPECT_NEAR(solved.rgb.solution.radiosity[k], rgb.solution.radiosity[k], 1e-3 * rgb.solution.radiosity[k]);
    EXPECT_NEAR(solved.rgb.solution.irradiance[k], rgb.solution.irradiance[k], 1e-3 * rgb.solution.irradiance[k]);
  }
  EXPECT_NEAR(solved.bands.energy.emitted, rgb.solution.energy.emitted, 1e-3 * rgb.solution.energy.emitted);
}

TEST(SpectralRadiosity, InterreflectionOfColoursDiffersAndDirectLightDoesNot) {
  const Scene scene = make_builtin_scene("cornell-box");
  const auto setup = make_radiosity_setup(scene, few(400));
  const SpectralProblem made = make_spectral_problem(scene, *setup);
  const std::vector<double> emission = to_rgb(made.edges, made.problem.emission);
  double direct = 0, all = 0, largest = 0;
  for (std::size_t k = 0; k < emission.size(); ++k) {
    direct = std::max(direct, std::abs(emission[k] - setup->problem.emission[k]));
    largest = std::max(largest, setup->problem.emission[k]);
  }
  EXPECT_LT(direct, 2e-3 * largest);  // within a band of 10 nm light has the shape of D65, not of the lamp
  const auto solved = solve_spectral(scene, *setup, exact);
  const auto rgb = solve(*setup, exact);
  for (std::size_t k = 0; k < emission.size(); ++k) {
    all = std::max(all, std::abs(solved.rgb.solution.radiosity[k] - rgb.solution.radiosity[k]) / largest);
  }
  EXPECT_GT(all, 1e-3);
  EXPECT_LT(all, 0.1);
}

/// The furnace of the table as a scene: a room and a box of one dye that shines in bands.
TEST(SpectralRadiosity, SixBandFurnaceAsAScene) {
  const auto table = nlohmann::json::parse(
      std::ifstream(PENUMBRA_TEST_DATA "/optics_spectrum.json"))["fluorescence"]["furnace_six_band"];
  std::vector<double> edges = table["bands_nm"].get<std::vector<double>>(), matrix;
  edges.push_back(740);
  for (const auto& row : table["D"]) {
    for (const double share : row) matrix.push_back(share);
  }
  Scene scene = make_builtin_scene("furnace");
  Material& paint = scene.materials[0];
  paint.fluorescence = Fluorescence{edges, matrix};
  paint.emission_spectrum = EmissionSpectrum{edges, {}};
  for (const double e : table["E"]) paint.emission_spectrum->radiance.push_back(e / pi);
  paint.emission = paint.emission_spectrum->colour();
  const auto setup = make_radiosity_setup(scene, few(300));
  const SpectralRadiosity solved = solve_spectral(scene, *setup, exact);
  // Our bands divide the table's; the sums over each are its.
  const std::size_t bands = solved.edges.size() - 1;
  for (std::size_t i = 0; i < setup->mesh.surface_count(); ++i) {
    if (setup->mesh.surfaces[i].back) continue;  // the outside of the room, and the dark inside of the box
    std::vector<double> sums(7, 0.0);
    for (std::size_t b = 0; b < bands; ++b) {
      sums[band_of(edges, (solved.edges[b] + solved.edges[b + 1]) / 2)] += solved.bands.radiosity[i * bands + b];
    }
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(sums[k], table["B"][k].get<double>(), 2e-3 * sums[k]);
    EXPECT_EQ(sums[6], 0) << "nothing outside the bands";
  }
  EXPECT_NEAR(solved.bands.energy.absorbed + solved.bands.energy.escaped, solved.bands.energy.emitted,
              1e-3 * solved.bands.energy.emitted);
}

TEST(SpectralRadiosity, ADyeShinesWhereTheLampDoesNot) {
  Scene scene = make_builtin_scene("fluorescent");
  // Flat things are quick: the table wears the dye of the first ball.
  for (Material& m : scene.materials) {
    if (m.name == "table") m.fluorescence = scene.materials[scene.shapes[0].material].fluorescence;
  }
  scene.shapes.clear();
  const auto setup = make_radiosity_setup(scene, few(600));
  const auto solved = solve_spectral(scene, *setup, exact);
  const auto rgb = solve(*setup, exact);
  double green = 0, without = 0;
  for (std::size_t i = 0; i < setup->mesh.surface_count(); ++i) {
    if (scene.object_name(setup->mesh.surfaces[i].object) != "table") continue;
    green = std::max(green, solved.rgb.solution.radiosity[3 * i + 1]);
    without = std::max(without, rgb.solution.radiosity[3 * i + 1]);
  }
  EXPECT_GT(green, 5 * without);
}

TEST(SpectralRadiosity, WithoutAMatrixItIsRefused) {
  const Scene scene = make_builtin_scene("furnace");
  RadiositySetupOptions options = few(200);
  options.solver = "shooting";
  options.form_factors = "hemicube";
  const auto setup = make_radiosity_setup(scene, options);
  EXPECT_THROW((void)solve_spectral(scene, *setup, exact), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
