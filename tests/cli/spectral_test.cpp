#include <gtest/gtest.h>

#include <filesystem>

#include "cli/program.h"

namespace penumbra::test {
namespace {

TEST(SpectralCommand, PathAndWhittedDrawThePrism) {
  const Workshop shop;
  for (const char* integrator : {"path", "whitted"}) {
    const Outcome drawn = penumbra({"render", "builtin:prism", "--integrator", integrator, "--spectral", "--spp", "2",
                                    "--size", "16x12", "-o", shop.path("p.png"), "--json"});
    ASSERT_EQ(drawn.code, 0) << drawn.err;
  }
}

TEST(SpectralCommand, OtherMethodsRefuseItWithTheReason) {
  const Workshop shop;
  for (const char* integrator : {"appel", "radiosity", "two-pass"}) {
    const Outcome refused =
        penumbra({"render", "builtin:cornell-box", "--integrator", integrator, "--spectral", "-o", shop.path("p.png")});
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("--spectral"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find(integrator), std::string::npos) << refused.err;
  }
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"-o", "x.glb"}, {"-o", "x.npz", "--solver", "shooting"}}) {
    std::vector<std::string> words{"bake", "builtin:furnace", "--spectral"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome refused = penumbra(words);
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("--spectral"), std::string::npos) << refused.err;
  }
}

TEST(SpectralCommand, ABakeOverBandsKeepsEnergyAndIsNoSolutionForPictures) {
  const Workshop shop;
  const Outcome baked = penumbra(
      {"bake", "builtin:furnace", "--spectral", "--elements", "200", "-o", shop.path("f.npz"), "--json", "-q"});
  ASSERT_EQ(baked.code, 0) << baked.err;
  const auto energy = baked.report()["energy"];
  const double emitted = energy["emitted"].get<double>();
  EXPECT_GT(emitted, 0);
  EXPECT_NEAR(energy["absorbed"].get<double>() + energy["escaped"].get<double>() + energy["unshot"].get<double>(),
              emitted, 1e-3 * emitted);
  const Outcome shown = penumbra({"render", "builtin:furnace", "--integrator", "radiosity", "--solution",
                                  shop.path("f.npz"), "-o", shop.path("f.png")});
  EXPECT_EQ(shown.code, 2);
  EXPECT_NE(shown.err.find("wavelength"), std::string::npos) << shown.err;
}

}  // namespace
}  // namespace penumbra::test
