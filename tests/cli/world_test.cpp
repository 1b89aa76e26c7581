// Air, sky and luminaires as the command line adds them.

#include <gtest/gtest.h>

#include "cli/program.h"
#include "cli/small_scenes.h"
#include "penumbra/image/image_io.h"

namespace penumbra::test {
namespace {

const std::string box = "builtin:cornell-box";

std::string refusal(std::vector<std::string> arguments) {
  const Workshop workshop;
  arguments.insert(arguments.begin(), "render");
  arguments.insert(arguments.end(), {"-o", workshop.path("a.exr"), "--size", "8x6", "--spp", "1"});
  const Outcome run = penumbra(arguments);
  EXPECT_EQ(run.code, 2) << run.err;
  EXPECT_TRUE(workshop.contents().empty());
  return run.err;
}

double mean(const std::vector<std::string>& more) {
  const Workshop workshop;
  std::vector<std::string> arguments{"render", box, "-q", "-o", workshop.path("a.exr"), "--size", "24x24"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome run = penumbra(arguments);
  EXPECT_EQ(run.code, 0) << run.err;
  const Image image = read_image(workshop.path("a.exr"));
  double sum = 0;
  for (const float v : image.data) sum += v;
  return sum / static_cast<double>(image.data.size());
}

TEST(WorldTest, FogTakesLightAndScattersIt) {
  const double clear = mean({"--spp", "16"});
  const double soot = mean({"--spp", "16", "--fog", "2,0,0"});
  const double mist = mean({"--spp", "16", "--fog", "2,1,0"});
  EXPECT_LT(soot, 0.5 * clear);
  EXPECT_GT(mist, 1.2 * soot);
}

TEST(WorldTest, WrongValuesAreRefused) {
  EXPECT_NE(refusal({box, "--fog", "0,0.5,0"}).find("--fog takes"), std::string::npos);
  EXPECT_NE(refusal({box, "--fog", "1,1.5,0"}).find("--fog takes"), std::string::npos);
  EXPECT_NE(refusal({box, "--fog", "1,1,1"}).find("--fog takes"), std::string::npos);
  EXPECT_NE(refusal({box, "--fog", "1"}).find("--fog takes"), std::string::npos);
  EXPECT_NE(refusal({box, "--sky", "100,0"}).find("--sky takes"), std::string::npos);
  EXPECT_NE(refusal({box, "--sky", "40,0,30"}).find("--sky takes"), std::string::npos);
  EXPECT_NE(refusal({box, "--sky", "40"}).find("--sky takes"), std::string::npos);
  EXPECT_NE(refusal({box, "--sky", "40,0", "--environment", "1,1,1"}).find("leave one"), std::string::npos);
  EXPECT_NE(refusal({box, "--ies", "lamp.ies"}).find("FILE@LIGHT"), std::string::npos);
  EXPECT_NE(refusal({box, "--ies", "lamp.ies@lamp"}).find("no point or spot light"), std::string::npos);
  EXPECT_NE(refusal({"builtin:fog", "--ies", "missing.ies@spot"}).find("missing.ies"), std::string::npos);
  EXPECT_NE(refusal({box, "--smoke", "smoke.txt"}).find("smoke.txt"), std::string::npos);
  EXPECT_NE(refusal({box, "--fog", "1,0,0", "--integrator", "appel"}).find("whitted or path"), std::string::npos);
}

TEST(WorldTest, SkyLightsASceneWithoutLight) {
  const Workshop workshop;
  const std::string square = matt_square(workshop, 0, 1);
  const Outcome run =
      penumbra({"render", square, "--sky", "60,0", "--size", "8x6", "--spp", "4", "-o", workshop.path("a.exr")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err.find("no light"), std::string::npos) << run.err;
}

TEST(WorldTest, BakesThroughAirThatAbsorbs) {
  const Workshop workshop;
  const std::vector<std::string> few{"--elements", "200", "--json"};
  const auto bake = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"bake", box});
    more.insert(more.end(), few.begin(), few.end());
    return penumbra(more);
  };
  const Outcome soot = bake({"--fog", "0.5,0,0", "-o", workshop.path("soot.npz")});
  ASSERT_EQ(soot.code, 0) << soot.err;
  const auto energy = soot.report()["energy"];
  EXPECT_GT(energy["absorbed_by_air"].get<double>(), 0.05 * energy["emitted"].get<double>());
  EXPECT_NE(bake({"--fog", "0.5,0.5,0", "-o", workshop.path("mist.npz")}).err.find("scatters"), std::string::npos);
  const Outcome viewer = penumbra({"bake", box, "--fog", "0.5,0,0", "-o", workshop.path("soot.glb")});
  EXPECT_EQ(viewer.code, 2);
  EXPECT_NE(viewer.err.find("clear air"), std::string::npos) << viewer.err;
}

TEST(WorldTest, ALuminaireHangsOnANamedLight) {
  const Workshop workshop;
  const std::string lamp =
      workshop.file("lamp.ies", "IESNA91\nTILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1000 0\n");
  const Outcome run = penumbra({"render", "builtin:fog?sigma_t=0", "--ies", lamp + "@spot", "--size", "8x6", "--spp",
                                "1", "-o", workshop.path("a.exr")});
  EXPECT_EQ(run.code, 0) << run.err;
}

}  // namespace
}  // namespace penumbra::test
