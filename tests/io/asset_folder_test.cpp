#include "penumbra/io/asset_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <string>

namespace penumbra::test {
namespace {

namespace fs = std::filesystem;

/// A folder `models` with a file and links in it, and a secret beside the folder.
class AssetFolderTest : public ::testing::Test {
 protected:
  AssetFolderTest() : top_(fs::temp_directory_path() / ("penumbra-assets-" + std::to_string(getpid()))) {
    fs::create_directories(top_ / "models/pictures");
    write(top_ / "secret.png");
    write(top_ / "models/pictures/wood.png");
    fs::create_symlink("pictures/wood.png", top_ / "models/within.png");
    fs::create_symlink("../secret.png", top_ / "models/out.png");
    fs::create_directory_symlink("..", top_ / "models/up");
    fs::create_directory_symlink(top_ / "models", top_ / "linked_models");
  }
  ~AssetFolderTest() override { fs::remove_all(top_); }

  static void write(const fs::path& path) { std::ofstream(path) << "x"; }

  /// What is wrong with a name, or "" when it is right.
  static std::string refusal(const AssetFolder& folder, std::string_view name) {
    try {
      (void)folder.resolve(name);
      return "";
    } catch (const std::invalid_argument& wrong) {
      return wrong.what();
    }
  }

  fs::path top_;
};

TEST_F(AssetFolderTest, FindsWhatLiesInTheFolderOrBelow) {
  const AssetFolder folder(top_ / "models/room.gltf");
  EXPECT_TRUE(fs::exists(folder.resolve("pictures/wood.png")));
  EXPECT_TRUE(fs::exists(folder.resolve("pictures\\wood.png")));
  EXPECT_TRUE(fs::exists(folder.resolve("pictures/../pictures/wood.png")));
  EXPECT_TRUE(fs::exists(folder.resolve("within.png")));  // a link that stays inside
  EXPECT_FALSE(fs::exists(folder.resolve("none.png")));   // there or not is for the reader to say
}

TEST_F(AssetFolderTest, WhatIsNotThereDoesNotLeaveTheCurrentFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(top_ / "models");
  const AssetFolder folder("room.gltf");
  EXPECT_EQ(refusal(folder, "none.png"), "");
  EXPECT_EQ(refusal(folder, "none/none.png"), "");
  EXPECT_NE(refusal(folder, "out.png"), "");
  fs::current_path(before);
}

TEST_F(AssetFolderTest, RefusesWhatLiesOutside) {
  const AssetFolder folder(top_ / "models/room.gltf");
  for (const std::string& name :
       {(top_ / "secret.png").string(), std::string("../secret.png"), std::string("pictures/../../secret.png"),
        std::string("..\\secret.png"), std::string("C:\\secret.png"), std::string("out.png"),
        std::string("up/secret.png"), std::string("up/up/anything")}) {
    EXPECT_NE(refusal(folder, name).find("--allow-outside"), std::string::npos)
        << name << ": " << refusal(folder, name);
  }
  EXPECT_NE(refusal(folder, "out.png").find("symbolic link"), std::string::npos);
}

TEST_F(AssetFolderTest, AFolderReachedByALinkIsStillItsOwn) {
  const AssetFolder folder(top_ / "linked_models/room.gltf");
  EXPECT_EQ(refusal(folder, "pictures/wood.png"), "");
  EXPECT_NE(refusal(folder, "out.png"), "");
}

TEST_F(AssetFolderTest, ReadsOutsideWhenAllowed) {
  const AssetFolder folder(top_ / "models/room.gltf", true);
  EXPECT_TRUE(fs::exists(folder.resolve((top_ / "secret.png").string())));
  EXPECT_TRUE(fs::exists(folder.resolve("../secret.png")));
  EXPECT_TRUE(fs::exists(folder.resolve("out.png")));
}

// A pipe or a device has no end.
TEST_F(AssetFolderTest, WhatIsNoOrdinaryFileIsRefusedInAnyCase) {
  ASSERT_EQ(::mkfifo((top_ / "models/pipe.png").c_str(), 0600), 0);
  for (const bool allowed : {false, true}) {
    const AssetFolder folder(top_ / "models/room.gltf", allowed);
    for (const std::string name : {"pipe.png", "pictures"}) {
      EXPECT_NE(refusal(folder, name).find("no ordinary file"), std::string::npos) << name;
    }
  }
  EXPECT_NE(refusal(AssetFolder(top_ / "models/room.gltf", true), "/dev/zero").find("no ordinary file"),
            std::string::npos);
}

TEST_F(AssetFolderTest, ANameOfNothingIsRefusedInAnyCase) {
  for (const bool allowed : {false, true}) {
    const AssetFolder folder(top_ / "models/room.gltf", allowed);
    EXPECT_NE(refusal(folder, ""), "");
    EXPECT_NE(refusal(folder, std::string_view("wood\0.png", 9)), "");
  }
}

}  // namespace
}  // namespace penumbra::test
