#include "penumbra/io/scene_reader.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "io/temporary_file.h"
#include "penumbra/file/file_error.h"
#include "penumbra/scene/builtin_scenes.h"

namespace penumbra {
namespace {

std::string refusal(std::string_view source) {
  try {
    static_cast<void>(read_scene(source));
  } catch (const FileError& error) {
    return error.what();
  }
  return "no FileError";
}

TEST(SceneReader, MakesEveryBuiltinScene) {
  for (const BuiltinScene& builtin : builtin_scenes()) {
    const auto loaded = read_scene("builtin:" + std::string(builtin.name));
    EXPECT_GT(loaded.scene.object_count(), 0U) << builtin.name;
    EXPECT_NO_THROW(validate(loaded.scene)) << builtin.name;
  }
  EXPECT_THROW(static_cast<void>(read_scene("builtin:no-such-scene")), std::invalid_argument);
}

TEST(SceneReader, ReadsObjByItsExtensionWhateverItsCase) {
  const std::string_view text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const char* extension : {".obj", ".OBJ"}) {
    const test::TemporaryFile file(text, extension);
    const auto loaded = read_scene(file.path().string(), {.unit = 0.01});
    EXPECT_EQ(loaded.scene.triangle_count(), 1U);
    EXPECT_DOUBLE_EQ(loaded.scene.bounds().upper.x, 0.01);
  }
}

TEST(SceneReader, OtherFormatsAreRefusedWithTheKnownOnes) {
  for (const char* source : {"a.blend", "a", "/tmp", ""}) {
    EXPECT_NE(refusal(source).find(".glb, .gltf or .obj"), std::string::npos) << refusal(source);
  }
}

TEST(SceneReader, AMissingFileIsSaidToBeMissing) {
  for (const char* source : {"/no/such/scene.glb", "/no/such/scene.gltf", "/no/such/scene.obj"}) {
    EXPECT_EQ(refusal(source), std::string(source) + ": no such file; check the path and its spelling");
  }
}

}  // namespace
}  // namespace penumbra
