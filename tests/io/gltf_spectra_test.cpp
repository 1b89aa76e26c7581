// Dispersion, fluorescence and emission spectra of glTF materials.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <variant>

#include "io/gltf_builder.h"
#include "penumbra/file/file_error.h"
#include "penumbra/io/gltf_writer.h"
#include "penumbra/scene/builtin_scenes.h"
#include "test_paths.h"

namespace penumbra::test {
namespace {

GltfBuilder triangle_of(nlohmann::json material) {
  GltfBuilder builder;
  builder.add("materials", std::move(material));
  builder.show(
      {{"attributes", {{"POSITION", builder.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", gltf_float)}}},
       {"material", 0}});
  return builder;
}

nlohmann::json glass(double dispersion) {
  return {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
          {"extensions",
           {{"KHR_materials_ior", {{"ior", 1.7}}},
            {"KHR_materials_transmission", {{"transmissionFactor", 1}}},
            {"KHR_materials_volume", {{"thicknessFactor", 1}}},
            {"KHR_materials_dispersion", {{"dispersion", dispersion}}}}}};
}

nlohmann::json dye(const nlohmann::json& matrix) {
  return {{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
          {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}},
          {"extras", {{"penumbra", {{"fluorescence", {{"edges_nm", {380, 450, 550}}, {"matrix", matrix}}}}}}}};
}

std::string refusal(const nlohmann::json& material) {
  try {
    (void)triangle_of(material).read();
  } catch (const FileError& e) {
    return e.what();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(GltfSpectra, DispersionIs20OverAbbesNumber) {
  auto builder = triangle_of(glass(0.5));
  const auto loaded = builder.read();
  const Material& m = loaded.scene.materials[0];
  ASSERT_TRUE(m.dispersion);
  EXPECT_NEAR(abbe_number(*m.dispersion), 40, 1e-6);
  EXPECT_NEAR(refractive_index(*m.dispersion, line_d), 1.7, 1e-6);
  EXPECT_EQ(warnings_with(loaded, "KHR_materials_dispersion"), 0);
  EXPECT_FALSE(triangle_of(glass(0)).read().scene.materials[0].dispersion);
  EXPECT_NE(refusal(glass(-1)).find("must not be negative"), std::string::npos);
}

TEST(GltfSpectra, SellmeierAndCauchySetTheIndex) {
  auto material = glass(0.1);
  material["extras"]["penumbra"]["sellmeier"] = {{"b", {1.03961212, 0.231792344, 1.01046945}},
                                                 {"c_um2", {0.00600069867, 0.0200179144, 103.560653}}};
  const Material schott = triangle_of(material).read().scene.materials[0];
  EXPECT_NEAR(schott.ior, 1.5168, 1e-4);
  EXPECT_TRUE(std::holds_alternative<Sellmeier>(*schott.dispersion));
  material["extras"]["penumbra"] = {{"cauchy", {{"a", 1.5}, {"b_um2", 0.01}}}};
  const Material plain = triangle_of(material).read().scene.materials[0];
  EXPECT_NEAR(refractive_index(*plain.dispersion, 500), 1.54, 1e-12);
  material["extras"]["penumbra"] = {{"sellmeier", {{"b", {1, 1, 1}}, {"c_um2", {0.25, 0, 0}}}}};
  EXPECT_NE(refusal(material), "") << "an absorption band in the visible";
}

TEST(GltfSpectra, FluorescenceGoesToLongerWavelengthsOnly) {
  EXPECT_EQ(refusal(dye({0.2, 0, 0.5, 0.3})), "");
  EXPECT_NE(refusal(dye({0.2, 0.1, 0.5, 0.3})).find("shorter wavelengths"), std::string::npos);
  EXPECT_NE(refusal(dye({0.2, 0, 0.5})).find("2 x 2"), std::string::npos);
  auto glossy = dye({0.2, 0, 0.5, 0.3});
  glossy.erase("extensions");
  EXPECT_NE(refusal(glossy).find("matt"), std::string::npos);
}

TEST(GltfSpectra, EmissionSpectraBringTheirColour) {
  nlohmann::json lamp = {
      {"extras", {{"penumbra", {{"emission_spectrum", {{"edges_nm", {400, 420}}, {"radiance", {5}}}}}}}}};
  const Material m = triangle_of(lamp).read().scene.materials[0];
  EXPECT_NEAR(m.emission_spectrum->at(410), 0.25, 1e-12);
  EXPECT_GT(m.emission.z, m.emission.x);
  lamp["extras"]["penumbra"]["emission_spectrum"]["radiance"] = {5, 6};
  EXPECT_NE(refusal(lamp), "");
}

TEST(GltfSpectra, WhatIsWrittenIsReadAgain) {
  for (const char* name : {"prism", "fluorescent"}) {
    const Scene scene = make_builtin_scene(name);
    const TemporaryFolder folder;
    const auto file = folder.path() / "scene.glb";
    (void)write_glb(file, scene);
    const Scene again = read_gltf(file).scene;
    for (const Material& m : scene.materials) {
      const auto same = std::find_if(again.materials.begin(), again.materials.end(),
                                     [&](const Material& other) { return other.name == m.name; });
      ASSERT_NE(same, again.materials.end()) << m.name;
      ASSERT_EQ(m.dispersion.has_value(), same->dispersion.has_value()) << m.name;
      if (m.dispersion) {
        EXPECT_EQ(refractive_index(*m.dispersion, 450), refractive_index(*same->dispersion, 450));
      }
      ASSERT_EQ(m.fluorescence.has_value(), same->fluorescence.has_value()) << m.name;
      if (m.fluorescence) {
        EXPECT_EQ(m.fluorescence->matrix, same->fluorescence->matrix);
        EXPECT_EQ(m.fluorescence->edges, same->fluorescence->edges);
      }
      ASSERT_EQ(m.emission_spectrum.has_value(), same->emission_spectrum.has_value()) << m.name;
      if (m.emission_spectrum) {
        EXPECT_EQ(m.emission_spectrum->radiance, same->emission_spectrum->radiance);
        EXPECT_LT(length(m.emission - same->emission), 1e-5F);
      }
    }
  }
}

// The guide has a file for each key.
TEST(GltfSpectra, FilesOfTheGuideHoldWhatTheySay) {
  const auto materials = [](const std::string& name) {
    const auto loaded =
        read_gltf(std::filesystem::path(PENUMBRA_TEST_DATA) / "../../docs/guide/files" / (name + ".gltf"));
    EXPECT_TRUE(loaded.warnings.empty()) << name << ": " << (loaded.warnings.empty() ? "" : loaded.warnings[0]);
    return loaded.scene.materials;
  };
  const auto holds = [](const std::vector<Material>& all, const auto& what) {
    return std::any_of(all.begin(), all.end(), what);
  };
  EXPECT_TRUE(holds(materials("dispersion"), [](const Material& m) {
    return m.dispersion && std::abs(abbe_number(*m.dispersion) - 20 / 0.7) < 1e-6;
  }));
  EXPECT_TRUE(holds(materials("sellmeier"), [](const Material& m) {
    return m.dispersion && std::abs(abbe_number(*m.dispersion) - 28.53) < 0.01;  // N-SF10
  }));
  EXPECT_TRUE(holds(materials("cauchy"),
                    [](const Material& m) { return m.dispersion && std::holds_alternative<Cauchy>(*m.dispersion); }));
  const auto dyed = materials("fluorescence");
  EXPECT_TRUE(holds(dyed, [](const Material& m) { return m.fluorescence && m.fluorescence->at(2, 0) == 0.6; }));
  EXPECT_TRUE(holds(dyed, [](const Material& m) { return m.emission_spectrum && m.emission.z > m.emission.y; }));
}

}  // namespace
}  // namespace penumbra::test
