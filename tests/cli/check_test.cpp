#include <gtest/gtest.h>

#include "cli/program.h"
#include "cli/small_scenes.h"

namespace penumbra::test {
namespace {

TEST(CheckCommand, ACleanSceneEndsWithZero) {
  const Outcome run = penumbra({"check", "builtin:cornell-box", "--json"});
  EXPECT_EQ(run.code, 0) << run.err << run.out;
  EXPECT_TRUE(run.report()["clean"].get<bool>());
  EXPECT_TRUE(run.report()["findings"].empty());
  EXPECT_EQ(penumbra({"check", "builtin:cornell-box"}).code, 0);
}

TEST(CheckCommand, FindingsEndWithThreeAndNameTheirPlace) {
  const Workshop shop;
  const std::string room =
      shop.file("room.obj",
                "mtllib room.mtl\nusemtl lamp\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 "
                "1\nv 1 1 1\nv 0 1 1\no shell\nf 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 4 3 7 8\nf 1 4 8 "
                "5\nf 2 6 7\n");
  shop.file("room.mtl", "newmtl lamp\nKd 0.9 0.9 0.9\nKs 0.3 0.3 0.3\nillum 3\nKe 1 1 1\n");
  const Outcome run = penumbra({"check", room, "--json"});
  ASSERT_EQ(run.code, 3) << run.err;
  ASSERT_EQ(run.report()["findings"].size(), 2U) << run.out;
  const auto hole = run.report()["findings"][0];
  EXPECT_EQ(hole["kind"], "hole");
  EXPECT_NEAR(hole["position"][0].get<double>(), 1, 1e-9);
  EXPECT_GT(hole["position"][1].get<double>(), 0.5);
  EXPECT_EQ(run.report()["findings"][1]["kind"], "reflectance");
  const Outcome spoken = penumbra({"check", room});
  EXPECT_EQ(spoken.code, 3);
  EXPECT_EQ(spoken.out.rfind("hole: ", 0), 0U) << spoken.out;
}

TEST(CheckCommand, AnUnlitSceneIsAFinding) {
  const Workshop shop;
  const Outcome run = penumbra({"check", matt_square(shop), "--json"});
  ASSERT_EQ(run.code, 3) << run.err;
  ASSERT_EQ(run.report()["findings"].size(), 1U) << run.out;
  EXPECT_EQ(run.report()["findings"][0]["kind"], "no-light");
}

TEST(CheckCommand, BadUsageEndsWithTwo) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"check"},
                                             {"check", "none.obj"},
                                             {"check", "builtin:nothing"},
                                             {"check", "builtin:furnace", "--sides", "both"},
                                             {"check", "builtin:furnace", "--unit", "mm"}}) {
    EXPECT_EQ(penumbra(arguments).code, 2) << arguments.back();
  }
}

}  // namespace
}  // namespace penumbra::test
