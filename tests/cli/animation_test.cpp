// Files that move, on the command line.

#include <gtest/gtest.h>

#include "cli/program.h"

namespace penumbra::test {
namespace {

/// A white square that goes from left to right within a second, and a camera before it; everything in one file.
std::string sliding_square(const Workshop& workshop) {
  // The buffer: four corners, six indices, two times, two places.
  return workshop.file("sliding.gltf", R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}, {"name": "empty", "nodes": [1]}],
    "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 5]}],
    "cameras": [{"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 2, "znear": 0, "zfar": 9}}],
    "materials": [{"extensions": {"KHR_materials_unlit": {}}}], "extensionsUsed": ["KHR_materials_unlit"],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
    "animations": [{"name": "slide", "samplers": [{"input": 2, "output": 3}],
                    "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
                  {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR"},
                  {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
                    {"buffer": 0, "byteOffset": 60, "byteLength": 8}, {"buffer": 0, "byteOffset": 68, "byteLength": 24}],
    "buffers": [{"byteLength": 92, "uri": "data:;base64,AACAvwAAAL8AAAAAAAAAAAAAAL8AAAAAAAAAAAAAAD8AAAAAAACAvwAAAD8AAAAAAAABAAIAAAACAAMAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAA="}]})");
}

double mean_of(const Workshop& workshop, const std::vector<std::string>& options, const std::string& region) {
  std::vector<std::string> arguments = {"render",
                                        sliding_square(workshop),
                                        "-o",
                                        workshop.path("a.exr"),
                                        "--size",
                                        "8x8",
                                        "--environment",
                                        "0,0,0",
                                        "--spp",
                                        "256",
                                        "-q",
                                        "--region",
                                        region};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome drawn = penumbra(arguments);
  EXPECT_EQ(drawn.code, 0) << drawn.err;
  const Outcome compared = penumbra({"compare", workshop.path("a.exr"), workshop.path("a.exr"), "--json"});
  return compared.report()["mean_a"];
}

TEST(Animation, TimeMovesAndTheShutterBlurs) {
  const Workshop workshop;
  const std::string left = "2,3,4,5", right = "4,3,6,5";
  const double whole = mean_of(workshop, {"--time", "0"}, left);
  EXPECT_NEAR(whole, 4.0 / 64, 1e-6);
  EXPECT_EQ(mean_of(workshop, {"--time", "0"}, right), 0);
  EXPECT_EQ(mean_of(workshop, {"--time", "1"}, left), 0);
  EXPECT_NEAR(mean_of(workshop, {"--time", "1"}, right), whole, 1e-6);
  EXPECT_NEAR(mean_of(workshop, {"--animation", "slide", "--time", "0.5"}, left), whole / 2, 1e-3);
  EXPECT_NEAR(mean_of(workshop, {"--shutter", "0,1"}, left), whole / 2, 2e-3);
  EXPECT_NEAR(mean_of(workshop, {"--shutter", "0,1", "--integrator", "path"}, right), whole / 2, 2e-3);
  EXPECT_NEAR(mean_of(workshop, {"--shutter", "0,0.5", "--integrator", "appel"}, right), whole / 4, 2e-3);
}

TEST(Animation, WrongChoicesNameWhatThereIs) {
  const Workshop workshop;
  const std::string file = sliding_square(workshop);
  const Outcome run = penumbra({"render", file, "-o", workshop.path("a.png"), "--time", "1", "--animation", "jump"});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("it has 0 'slide'"), std::string::npos) << run.err;
  const Outcome scene = penumbra({"render", file, "-o", workshop.path("a.png"), "--scene", "attic"});
  EXPECT_EQ(scene.code, 2);
  EXPECT_NE(scene.err.find("0, 1 'empty'"), std::string::npos) << scene.err;
}

}  // namespace
}  // namespace penumbra::test
