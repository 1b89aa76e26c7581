#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <numbers>

#include "cli/program.h"
#include "cli/small_scenes.h"
#include "penumbra/image/image_io.h"

namespace penumbra::test {
namespace {

// rho = 0.5, radiance emitted 1: light adds up to radiance 2 and irradiance 2 pi everywhere inside.
const std::string furnace = "builtin:furnace?rho=0.5&emission=1";

/// The JSON of a .glb.
nlohmann::json json_of(const std::string& path) {
  const std::string bytes = read_text(path);
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  return nlohmann::json::parse(bytes.substr(20, length));
}

std::vector<std::string> bake_words(const std::string& scene, const std::string& out, const std::string& profile) {
  return {"bake", scene, "-o", out, "--profile", profile, "--lightmap-size", "64", "-q", "--json"};
}

TEST(BakeLightmap, AFurnaceShinesEvenlyInEveryProfile) {
  const Workshop shop;
  for (const char* profile : {"unlit", "hdr"}) {
    std::vector<std::string> words = bake_words(furnace, shop.path("f.glb"), profile);
    words.insert(words.end(), {"--exposure", "-2"});
    const Outcome run = penumbra(words);
    ASSERT_EQ(run.code, 0) << run.err;
    const nlohmann::json report = run.report();
    EXPECT_EQ(report["profile"], profile);
    EXPECT_EQ(report["partial"], false);
    EXPECT_GT(report["elements"].get<int>(), 1000);
    // Seen from the middle, by a method that knows nothing of baking: radiance 2 at a quarter.
    const Outcome view = penumbra({"render", shop.path("f.glb"), "-o", shop.path("f.exr"), "--eye", "0.5,0.5,0.5",
                                   "--look-at", "0.9,0.6,0.1", "--fov", "90", "--size", "16x16", "-q"});
    ASSERT_EQ(view.code, 0) << view.err;
    const Image picture = read_image(shop.path("f.exr"));
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) EXPECT_NEAR(picture.rgb(x, y).x, 0.5, 0.02) << profile << ' ' << x << ' ' << y;
    }
  }
}

TEST(BakeLightmap, ThePictureBesideHoldsIrradiance) {
  const Workshop shop;
  const Outcome run = penumbra(bake_words(furnace, shop.path("f.glb"), "lightmap"));
  ASSERT_EQ(run.code, 0) << run.err;
  const Image picture = read_image(shop.path("f-lightmap.exr"));
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) EXPECT_NEAR(picture.rgb(x, y).y, 2 * std::numbers::pi, 0.15);
  }
  const auto description = nlohmann::json::parse(read_text(shop.path("f-lightmap.json")));
  EXPECT_EQ(description["lightmap"], "f-lightmap.exr");
  EXPECT_EQ(description["unit"], "W/m^2");
  EXPECT_EQ(description["width"], picture.width);
  const nlohmann::json gltf = json_of(shop.path("f.glb"));
  const auto& extension = gltf["materials"][0]["extensions"]["MOZ_lightmap"];
  EXPECT_EQ(extension["texCoord"], 1);
  EXPECT_NEAR(extension["intensity"].get<double>(), 2 * std::numbers::pi, 0.2);
  EXPECT_TRUE(gltf.value("extensionsRequired", nlohmann::json::array()).empty());
  EXPECT_EQ(shop.contents(), (std::vector<std::string>{"f-lightmap.exr", "f-lightmap.json", "f.glb"}));
}

TEST(BakeLightmap, TrianglesMaterialsAndNamesAreTheInputs) {
  const Workshop shop;
  ASSERT_EQ(penumbra({"scene", "cornell-box", "-o", shop.path("in.glb"), "-q"}).code, 0);
  const nlohmann::json before = json_of(shop.path("in.glb"));
  const auto names = [](const nlohmann::json& elements) {
    std::vector<std::string> all;
    for (const auto& e : elements) all.push_back(e.value("name", ""));
    return all;
  };
  const auto triangles = [](const nlohmann::json& gltf) {
    std::vector<int> counts;
    for (const auto& mesh : gltf["meshes"]) {
      for (const auto& part : mesh["primitives"]) {
        counts.push_back(gltf["accessors"][part["indices"].get<std::size_t>()]["count"].get<int>());
      }
    }
    return counts;
  };
  for (const char* profile : {"unlit", "hdr", "lightmap"}) {
    std::vector<std::string> words = bake_words(shop.path("in.glb"), shop.path("out.glb"), profile);
    words.insert(words.end(), {"--noise", "0.5"});
    const Outcome run = penumbra(words);
    ASSERT_EQ(run.code, 0) << run.err;
    const nlohmann::json after = json_of(shop.path("out.glb"));
    EXPECT_EQ(names(after["materials"]), names(before["materials"])) << profile;
    EXPECT_EQ(names(after["meshes"]), names(before["meshes"])) << profile;
    EXPECT_EQ(names(after["nodes"]), names(before["nodes"])) << profile;
    EXPECT_EQ(triangles(after), triangles(before)) << profile;
  }
}

TEST(BakeLightmap, UnlitIsWhatAGlbHoldsByDefault) {
  const Workshop shop;
  const Outcome run = penumbra(
      {"bake", furnace, "-o", shop.path("f.glb"), "--texels-per-metre", "8", "--noise", "0.5", "-q", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.report()["profile"], "unlit");
  const nlohmann::json gltf = json_of(shop.path("f.glb"));
  EXPECT_TRUE(gltf["materials"][0]["extensions"].contains("KHR_materials_unlit"));
  EXPECT_EQ(gltf["scenes"][0]["extras"]["penumbra"]["baked"]["profile"], "unlit");
}

}  // namespace
}  // namespace penumbra::test
