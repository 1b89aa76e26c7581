// `penumbra compare` and `penumbra scene` as scripts see them.

#include <gtest/gtest.h>

#include <cmath>

#include "cli/program.h"
#include "penumbra/image/image_io.h"

namespace penumbra::test {
namespace {

/// A picture whose every value is `value`.
std::string flat(const Workshop& workshop, const std::string& name, float value, int width = 16) {
  Image image(width, 12);
  for (float& v : image.data) v = value;
  write_image(workshop.path(name), image);
  return workshop.path(name);
}

TEST(CompareTest, EqualPicturesAreEqual) {
  const Workshop workshop;
  const std::string a = flat(workshop, "a.exr", 0.5F);
  const Outcome run = penumbra({"compare", a, a, "--json", "--max-rmse", "0"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.report().at("rmse"), 0);
  EXPECT_TRUE(run.report().at("psnr").is_null());
  EXPECT_EQ(run.report().at("ssim"), 1);
}

TEST(CompareTest, AConstantOffsetIsTheError) {
  const Workshop workshop;
  const Outcome run = penumbra({"compare", flat(workshop, "a.exr", 0.5F), flat(workshop, "b.exr", 0.25F), "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = run.report();
  EXPECT_NEAR(report.at("rmse").get<double>(), 0.25, 1e-12);
  EXPECT_NEAR(report.at("relative_rmse").get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(report.at("psnr").get<double>(), 20 * std::log10(1 / 0.25), 1e-9);
  EXPECT_NEAR(report.at("max").get<double>(), 0.25, 1e-12);
  EXPECT_NEAR(report.at("mean_a").get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(report.at("mean_b").get<double>(), 0.25, 1e-12);
  EXPECT_TRUE(report.contains("ssim"));
}

TEST(CompareTest, OverTheLimitExitsWithThree) {
  const Workshop workshop;
  const std::string a = flat(workshop, "a.exr", 0.5F);
  const std::string b = flat(workshop, "b.exr", 0.25F);
  EXPECT_EQ(penumbra({"compare", a, b, "--max-rmse", "0.26"}).code, 0);
  const Outcome over = penumbra({"compare", a, b, "--max-rmse", "0.24"});
  EXPECT_EQ(over.code, 3);
  EXPECT_NE(over.err.find("--max-rmse"), std::string::npos);
  EXPECT_NE(over.out.find("rmse"), std::string::npos);
}

TEST(CompareTest, SizesThatDifferAreRefused) {
  const Workshop workshop;
  const Outcome run = penumbra({"compare", flat(workshop, "a.exr", 1), flat(workshop, "b.exr", 1, 17)});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("b.exr: is 17x12 pixels"), std::string::npos) << run.err;
}

TEST(CompareTest, AFileThatIsNoPictureIsRefused) {
  const Workshop workshop;
  const Outcome run = penumbra({"compare", workshop.file("a.png", "not a picture"), flat(workshop, "b.exr", 1)});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("a.png"), std::string::npos) << run.err;
}

TEST(SceneTest, ListNamesTheBuiltInScenes) {
  const Outcome run = penumbra({"scene", "--list"});
  EXPECT_EQ(run.code, 0);
  for (const char* name : {"cornell-box", "cornell-spheres", "whitted", "furnace", "box345", "atrium"}) {
    EXPECT_NE(run.out.find(name), std::string::npos) << name;
  }
  const auto scenes = penumbra({"scene", "--list", "--json"}).report().at("scenes");
  EXPECT_GE(scenes.size(), 6U);
}

TEST(SceneTest, AWrittenSceneDrawsAsTheBuiltInOne) {
  const Workshop workshop;
  const Outcome written = penumbra({"scene", "cornell-box", "-q", "-o", workshop.path("box.glb")});
  ASSERT_EQ(written.code, 0) << written.err;
  EXPECT_EQ(written.err + written.out, "");
  const std::vector<std::string> how{"--size", "32x32", "--integrator", "path", "--spp", "16", "-q"};
  const auto draw = [&](const std::string& scene, const std::string& name) {
    std::vector<std::string> arguments{"render", scene, "-o", workshop.path(name)};
    arguments.insert(arguments.end(), how.begin(), how.end());
    EXPECT_EQ(penumbra(arguments).code, 0);
    return workshop.path(name);
  };
  const Outcome apart =
      penumbra({"compare", draw("builtin:cornell-box", "a.exr"), draw(workshop.path("box.glb"), "b.exr"), "--json"});
  // Single precision in the file moves edges and may reorder triangles; the mean must not move beyond noise.
  const double a = apart.report().at("mean_a");
  EXPECT_NEAR(apart.report().at("mean_b").get<double>(), a, 0.1 * a);
}

}  // namespace
}  // namespace penumbra::test
