// What --max-memory and folders that cannot be written do: a sentence and an exit code, never a starved machine.

#include <gtest/gtest.h>

#include "cli/program.h"
#include "cli/small_scenes.h"

namespace penumbra::test {
namespace {

/// A glTF of `nodes` nodes that share one mesh, which names the same triangle `triangles` times; returns the path.
std::string instanced(const Workshop& shop, int nodes, int triangles) {
  nlohmann::json gltf = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  // Three corners as little-endian floats, 0 but for x of the second and y of the third, which are 1.
  const std::string corners("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80?\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80?\0\0\0\0", 36);
  std::string hex;
  for (const unsigned char c : corners) {
    constexpr char digits[] = "0123456789ABCDEF";
    hex += std::string("%") + digits[c / 16] + digits[c % 16];
  }
  std::string order;
  for (int i = 0; i < 3 * triangles; ++i) order += i % 3 == 0 ? "%00" : i % 3 == 1 ? "%01" : "%02";
  gltf["buffers"] = {{{"byteLength", 36}, {"uri", "data:application/octet-stream," + hex}},
                     {{"byteLength", 3 * triangles}, {"uri", "data:application/octet-stream," + order}}};
  gltf["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}}, {{"buffer", 1}, {"byteLength", 3 * triangles}}};
  gltf["accessors"] = {{{"bufferView", 0},
                        {"componentType", 5126},
                        {"count", 3},
                        {"type", "VEC3"},
                        {"min", {0, 0, 0}},
                        {"max", {1, 1, 0}}},
                       {{"bufferView", 1}, {"componentType", 5121}, {"count", 3 * triangles}, {"type", "SCALAR"}}};
  gltf["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
  gltf["nodes"] = std::vector<nlohmann::json>(static_cast<std::size_t>(nodes), {{"mesh", 0}});
  std::vector<int> all(static_cast<std::size_t>(nodes));
  for (int n = 0; n < nodes; ++n) all[static_cast<std::size_t>(n)] = n;
  gltf["scenes"] = {{{"nodes", all}}};
  return shop.file("instanced.gltf", gltf.dump());
}

TEST(MemoryLimitTest, RefusesAThousandMillionTrianglesByInstancesBeforeTheFact) {
  const Workshop shop;
  const std::string scene = instanced(shop, 20000, 50000);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"bake", scene, "-o", shop.path("a.glb")},
        std::vector<std::string>{"bake", scene, "-o", shop.path("a.npz")},
        std::vector<std::string>{"factors", scene, "-o", shop.path("a.npz")},
        std::vector<std::string>{"check", scene}}) {
    const Outcome run = penumbra(arguments);
    EXPECT_EQ(run.code, 2) << arguments[0] << ": " << run.err;
    EXPECT_NE(run.err.find("1000000000 triangles"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("--max-memory"), std::string::npos) << run.err;
  }
  EXPECT_EQ(shop.contents(), std::vector<std::string>{"instanced.gltf"});
}

// Sanitizers end the program themselves when memory is refused.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(MemoryLimitTest, EndsWithASentenceWhenTheMemoryIsNotEnough) {
  const Workshop shop;
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"render", "builtin:atrium?triangles=5000000", "-o", shop.path("a.png")},
        std::vector<std::string>{"render", "builtin:cornell-box", "--size", "32000x32000", "-o", shop.path("a.png")}}) {
    std::vector<std::string> limited = arguments;
    limited.insert(limited.end(), {"--max-memory", "200e6"});
    const Outcome run = penumbra(limited);
    EXPECT_EQ(run.code, 1) << run.err;
    EXPECT_NE(run.err.find("--max-memory"), std::string::npos) << run.err;
  }
  EXPECT_TRUE(shop.contents().empty());
}
#endif

TEST(MemoryLimitTest, OrdinaryWorkFitsIntoTwoHundredMegabytes) {
  const Workshop shop;
  const Outcome picture =
      penumbra({"render", "builtin:cornell-box", "--size", "64x64", "--max-memory", "200e6", "-o", shop.path("a.png")});
  EXPECT_EQ(picture.code, 0) << picture.err;
  const Outcome factors = penumbra({"factors", "builtin:box345", "--max-memory", "200e6", "-o", shop.path("a.npz")});
  EXPECT_EQ(factors.code, 0) << factors.err;
}

TEST(MemoryLimitTest, RefusesWhatIsNoNumberOfBytes) {
  for (const std::string bytes : {"0", "-1", "much", "nan"}) {
    EXPECT_EQ(penumbra({"check", "builtin:cornell-box", "--max-memory", bytes}).code, 2) << bytes;
  }
}

// Root may write anywhere, but not where the system has no files.
TEST(UnwritableFolderTest, IsRefusedBeforeTheWork) {
  for (const std::string folder : {"/proc", "/sys"}) {
    for (const std::string command : {"render", "bake", "factors"}) {
      const std::string output = folder + (command == "factors" ? "/a.npz" : command == "bake" ? "/a.glb" : "/a.png");
      const Outcome run = penumbra({command, "builtin:cornell-box", "-o", output});
      EXPECT_EQ(run.code, 2) << command << ' ' << run.err;
      EXPECT_NE(run.err.find(output), std::string::npos) << run.err;
    }
  }
}

TEST(OutsideFilesTest, AreReadOnlyWhenAllowed) {
  const Workshop outside, shop;
  outside.file("red.mtl", "newmtl red\nKd 0.8 0.1 0.1\n");
  const std::string scene =
      shop.file("a.obj", "mtllib " + outside.path("red.mtl") + "\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::vector<std::string> render{"render", scene, "--size", "8x8", "--spp", "1", "-o", shop.path("a.exr")};
  const Outcome refused = penumbra(render);
  EXPECT_EQ(refused.code, 0);  // drawn without its materials
  EXPECT_NE(refused.err.find("--allow-outside"), std::string::npos) << refused.err;
  std::vector<std::string> allowing = render;
  allowing.emplace_back("--allow-outside");
  const Outcome allowed = penumbra(allowing);
  EXPECT_EQ(allowed.code, 0);
  EXPECT_EQ(allowed.err.find("MTL"), std::string::npos) << allowed.err;
}

}  // namespace
}  // namespace penumbra::test
