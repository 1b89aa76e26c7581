#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <numbers>

#include "cli/program.h"
#include "penumbra/image/image_io.h"

namespace penumbra::test {
namespace {

using std::numbers::pi;

// rho = 0.5, radiance emitted 1: light adds up to radiance 2 and irradiance 2 pi everywhere inside a room of 2 m
// with a tilted box in it.
const std::string furnace = "builtin:furnace?rho=0.5&emission=1";

struct Glb {
  nlohmann::json json;
  std::string binary;
};

Glb read_glb(const std::string& path) {
  const std::string bytes = read_text(path);
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  return {nlohmann::json::parse(bytes.substr(20, length)), bytes.substr(20 + length + 8)};
}

/// The picture of a glTF texture, sRGB decoded.
Image picture_of(const Workshop& shop, const Glb& glb, std::size_t texture) {
  const auto& image = glb.json["images"][glb.json["textures"][texture]["source"].get<std::size_t>()];
  const auto& view = glb.json["bufferViews"][image["bufferView"].get<std::size_t>()];
  const std::string path = shop.path("picture.png");
  std::ofstream(path, std::ios::binary) << glb.binary.substr(view.value("byteOffset", std::size_t{0}),
                                                             view["byteLength"].get<std::size_t>());
  return read_image(path);
}

TEST(BakeProbes, InAFurnaceLightIsTheSameFromAllAround) {
  const Workshop shop;
  const Outcome run = penumbra(
      {"bake", furnace, "-o", shop.path("p.json"), "--probes", "2x1x2", "--lightmap-size", "64", "-q", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.report()["probes"], 4);
  EXPECT_EQ(run.report()["probes_inside"], 0);
  EXPECT_EQ(shop.contents(), (std::vector<std::string>{"p.json", "p.npz"}));
  const auto probes = nlohmann::json::parse(read_text(shop.path("p.json")));
  EXPECT_EQ(probes["arrays"], "p.npz");
  EXPECT_EQ(probes["partial"], false);
  ASSERT_EQ(probes["coefficients"].size(), 4U);
  const std::vector<double> second{0.5, 0, -0.5};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(probes["positions"][1][k].get<double>(), second[k], 1e-6);
  for (const auto& probe : probes["coefficients"]) {
    ASSERT_EQ(probe.size(), 9U);
    for (std::size_t band = 0; band < 3; ++band) {
      const double mean = 2 * std::sqrt(4 * pi);
      EXPECT_NEAR(probe[0][band].get<double>(), mean, 0.02 * mean);
      for (std::size_t k = 1; k < 9; ++k) EXPECT_NEAR(probe[k][band].get<double>(), 0, 0.04 * mean) << k;
    }
  }
}

TEST(BakeProbes, StandWhereTheirBoundsSay) {
  const Workshop shop;
  const Outcome run = penumbra({"bake", furnace, "-o", shop.path("p.json"), "--probes", "1x1x3", "--probe-bounds",
                                "0.5,0.5,0.2,0.5,0.5,2", "--lightmap-size", "64", "--noise", "0.5", "-q"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto probes = nlohmann::json::parse(read_text(shop.path("p.json")));
  EXPECT_NEAR(probes["positions"][1][2].get<double>(), 1.1, 1e-9);
  // Outside of the cube most of what is seen is open.
  EXPECT_EQ(probes["inside"], (nlohmann::json{false, false, false})) << probes["inside"];
}

TEST(BakeOcclusion, NothingIsOpenInAClosedRoomAndAlmostAllWithinAMillimetre) {
  const Workshop shop;
  ASSERT_EQ(penumbra({"scene", "furnace", "-o", shop.path("in.glb"), "-q"}).code, 0);
  const Glb before = read_glb(shop.path("in.glb"));
  for (const bool near : {false, true}) {
    std::vector<std::string> words{
        "bake",  shop.path("in.glb"), "-o", shop.path("ao.glb"), "--profile", "ao", "--lightmap-size", "64", "-q",
        "--json"};
    if (near) words.insert(words.end(), {"--ao-distance", "0.001"});
    const Outcome run = penumbra(words);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.report()["profile"], "ao");
    const Glb after = read_glb(shop.path("ao.glb"));
    ASSERT_EQ(after.json["materials"].size(), before.json["materials"].size());
    for (std::size_t m = 0; m < after.json["materials"].size(); ++m) {
      nlohmann::json material = after.json["materials"][m];
      EXPECT_EQ(material["occlusionTexture"]["texCoord"], 1);
      material.erase("occlusionTexture");
      EXPECT_EQ(material, before.json["materials"][m]);
    }
    const Image open = picture_of(shop, after, after.json["materials"][0]["occlusionTexture"]["index"]);
    double sum = 0;
    for (const float v : open.data) sum += static_cast<double>(v);
    EXPECT_NEAR(sum / static_cast<double>(open.data.size()), near ? 1 : 0, near ? 0.1 : 1e-6);
  }
}

TEST(BakeDirectional, LightOfAFurnaceComesFromThePolesOfItsWalls) {
  const Workshop shop;
  const Outcome run = penumbra({"bake", furnace, "-o", shop.path("f.glb"), "--profile", "lightmap", "--directional",
                                "--lightmap-size", "32", "--noise", "0.02", "-q"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Image picture = read_image(shop.path("f-directional.exr"));
  const auto channel = [&](const char* name) {
    const auto found = std::find(picture.channels.begin(), picture.channels.end(), name);
    EXPECT_NE(found, picture.channels.end()) << name;
    return static_cast<std::size_t>(found - picture.channels.begin());
  };
  const std::size_t mean = channel("L00.G"), y = channel("L1-1.G"), z = channel("L10.G"), x = channel("L11.G");
  // Radiance 2 from one hemisphere.
  const double l0 = 2 * 2 * pi * std::sqrt(1 / (4 * pi)), l1 = 2 * pi * std::sqrt(3 / (4 * pi));
  double sum0 = 0, sum1 = 0;
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      const float* p = picture.pixel(column, row);
      EXPECT_NEAR(p[mean], l0, 0.05 * l0);
      EXPECT_NEAR(std::hypot(p[x], p[y], p[z]), l1, 0.05 * l1);
      sum0 += static_cast<double>(p[mean]), sum1 += std::hypot(p[x], p[y], p[z]);
    }
  }
  const double pixels = picture.width * picture.height;
  EXPECT_NEAR(sum0 / pixels, l0, 0.02 * l0);
  EXPECT_NEAR(sum1 / pixels, l1, 0.02 * l1);
  const auto description = nlohmann::json::parse(read_text(shop.path("f-lightmap.json")));
  EXPECT_EQ(description["directional"]["file"], "f-directional.exr");
}

TEST(BakeTexels, TheReportTellsWhereTheLightWent) {
  const Workshop shop;
  const Outcome run =
      penumbra({"bake", furnace, "-o", shop.path("f.glb"), "--lightmap-size", "64", "--noise", "0.05", "-q", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const nlohmann::json report = run.report();
  const double area = 6 * 4 + 2 * (0.7 * 0.6 + 0.7 * 0.5 + 0.6 * 0.5);
  const double emitted = area * pi * 3;  // W: radiosity pi, three bands
  EXPECT_NEAR(report["energy"]["emitted"].get<double>(), emitted, 1e-3 * emitted);
  EXPECT_NEAR(report["energy"]["absorbed"].get<double>(), emitted, 2e-3 * emitted);
  EXPECT_NEAR(report["energy"]["escaped"].get<double>(), 0, 2e-3 * emitted);
  EXPECT_LT(report["unshot_fraction"].get<double>(), 1e-3);
  EXPECT_EQ(report["residual"].size(), report["iterations"].get<std::size_t>());
  EXPECT_GT(report["residual"][0].get<double>(), report["residual"].back().get<double>());
}

TEST(BakeTexels, OptionsThatDoNotApplyAreRefused) {
  const Workshop shop;
  const std::string box = "builtin:cornell-box", glb = shop.path("o.glb"), json = shop.path("o.json");
  const std::vector<std::vector<std::string>> refused{
      {"bake", box, "-o", json},
      {"bake", box, "-o", glb, "--probes", "2x2x2"},
      {"bake", box, "-o", json, "--probes", "2x2"},
      {"bake", box, "-o", json, "--probes", "2x0x2"},
      {"bake", box, "-o", json, "--probes", "1000x1000x1000"},
      {"bake", box, "-o", json, "--probes", "2x2x2", "--probe-bounds", "1,0,0,0,1,1"},
      {"bake", box, "-o", json, "--probes", "2x2x2", "--elements", "100"},
      {"bake", box, "-o", json, "--probes", "2x2x2", "--exposure", "1"},
      {"bake", box, "-o", json, "--probes", "2x2x2", "--profile", "ao"},
      {"bake", box, "-o", glb, "--probe-bounds", "0,0,0,1,1,1"},
      {"bake", box, "-o", glb, "--directional"},
      {"bake", box, "-o", glb, "--profile", "ao", "--denoise"},
      {"bake", box, "-o", json, "--probes", "2x2x2", "--denoise"},
      {"bake", box, "-o", glb, "--ao-distance", "1"},
      {"bake", box, "-o", glb, "--profile", "ao", "--noise", "0.1"},
      {"bake", box, "-o", glb, "--profile", "ao", "--exposure", "1"},
      {"bake", box, "-o", glb, "--profile", "ao", "--environment", "1,1,1"},
      {"bake", box, "-o", glb, "--profile", "ao", "--directional"},
      {"bake", box, "-o", glb, "--profile", "vertex", "--opaque-shadows"},
      {"bake", box, "-o", shop.path("o.npz"), "--opaque-shadows"}};
  for (const auto& arguments : refused) {
    const Outcome run = penumbra(arguments);
    EXPECT_EQ(run.code, 2) << arguments.back();
    EXPECT_EQ(run.err.rfind("penumbra: ", 0), 0U) << run.err;
  }
  EXPECT_TRUE(shop.contents().empty());
}

}  // namespace
}  // namespace penumbra::test
