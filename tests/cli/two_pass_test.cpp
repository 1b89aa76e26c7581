#include <gtest/gtest.h>

#include <fstream>

#include "cli/program.h"
#include "cli/small_scenes.h"

namespace penumbra::test {
namespace {

TEST(TwoPassCommand, ASolutionServesASecondView) {
  const Workshop shop;
  ASSERT_EQ(penumbra({"bake", "builtin:cornell-box", "--elements", "300", "-o", shop.path("s.npz"), "-q"}).code, 0);
  const Outcome drawn = penumbra({"render", "builtin:cornell-box", "--integrator", "two-pass", "--solution",
                                  shop.path("s.npz"), "--size", "16x16", "-o", shop.path("s.png"), "--json"});
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_FALSE(drawn.report()["partial"].get<bool>());
  const Outcome other = penumbra({"render", "builtin:cornell-spheres", "--integrator", "two-pass", "--solution",
                                  shop.path("s.npz"), "--size", "16x16", "-o", shop.path("t.png")});
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("other surfaces"), std::string::npos) << other.err;
}

TEST(TwoPassCommand, OptionsThatDoNotApplyAreRefused) {
  const Workshop shop;
  EXPECT_EQ(penumbra({"render", "builtin:whitted", "--final-gather", "4", "-o", shop.path("a.png")}).code, 2);
  EXPECT_EQ(
      penumbra({"render", "builtin:cornell-box", "--integrator", "two-pass", "--flat", "-o", shop.path("a.png")}).code,
      2);
  EXPECT_EQ(penumbra({"render", "builtin:cornell-box", "--solution", "x.npz", "-o", shop.path("a.png")}).code, 2);
}

// A furnace's radiosity is pi L / (1 - rho): twice the emission, twice the light, and not a ray traced.
TEST(BakeAgain, OtherIntensitiesNeedNoNewFactors) {
  const Workshop shop;
  const auto furnace = [](int emission) { return "builtin:furnace?rho=0.5&emission=" + std::to_string(emission); };
  const Outcome first = penumbra({"bake", furnace(1), "--elements", "200", "--tolerance", "1e-8", "-o",
                                  shop.path("one.npz"), "--checkpoint", shop.path("c.check"), "--json", "-q"});
  ASSERT_EQ(first.code, 0) << first.err;
  const Outcome again = penumbra({"bake", furnace(2), "--resume", shop.path("c.check"), "--tolerance", "1e-8", "-o",
                                  shop.path("two.npz"), "--json", "-q"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.report()["seconds"]["form_factors"].get<double>(), 0);
  EXPECT_EQ(again.report()["links"], first.report()["links"]);
  const double once = first.report()["energy"]["absorbed"].get<double>();
  EXPECT_NEAR(again.report()["energy"]["absorbed"].get<double>(), 2 * once, 1e-5 * once);
}

TEST(BakeAgain, SlowResumedUnchangedItIsTheSameFile) {
  const Workshop shop;
  const std::string scene = "builtin:cornell-spheres";
  ASSERT_EQ(penumbra({"bake", scene, "--elements", "2200", "--form-factors", "hemicube", "--resolution", "16",
                      "--specular-rays", "16", "-o", shop.path("one.npz"), "--checkpoint", shop.path("c.check"), "-q"})
                .code,
            0);
  ASSERT_EQ(penumbra({"bake", scene, "--resume", shop.path("c.check"), "-o", shop.path("two.npz"), "-q"}).code, 0);
  EXPECT_TRUE(read_text(shop.path("one.npz")) == read_text(shop.path("two.npz")));
}

TEST(BakeAgain, AnotherSceneIsRefused) {
  const Workshop shop;
  ASSERT_EQ(penumbra({"bake", "builtin:furnace", "--elements", "100", "-o", shop.path("f.npz"), "--checkpoint",
                      shop.path("c.check"), "-q"})
                .code,
            0);
  const Outcome other =
      penumbra({"bake", "builtin:cornell-box", "--resume", shop.path("c.check"), "-o", shop.path("g.npz")});
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("other surfaces"), std::string::npos) << other.err;
  const Outcome options = penumbra(
      {"bake", "builtin:furnace", "--resume", shop.path("c.check"), "--elements", "50", "-o", shop.path("g.npz")});
  EXPECT_EQ(options.code, 2);
  std::ofstream(shop.path("broken")) << "no archive";
  EXPECT_EQ(penumbra({"bake", "builtin:furnace", "--resume", shop.path("broken"), "-o", shop.path("g.npz")}).code, 2);
}

}  // namespace
}  // namespace penumbra::test
