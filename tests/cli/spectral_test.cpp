#include <gtest/gtest.h>

#include <filesystem>

#include "cli/program.h"

namespace penumbra::test {
namespace {

TEST(SpectralCommand, PathWhittedAndLightDrawThePrism) {
  const Workshop shop;
  for (const char* integrator : {"path", "whitted", "light"}) {
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

// Dyes that red, green and blue cannot show are told of once; with wavelengths there is nothing to tell.
TEST(SpectralCommand, DyesAreWarnedOfWithoutWavelengths) {
  const Workshop shop;
  std::vector<std::string> words{"render", "builtin:fluorescent", "--integrator", "path", "--spp", "1", "--size", "8x6",
                                 "-o",     shop.path("d.png")};
  const std::string told = penumbra(words).err;
  const std::size_t at = told.find("green dye");
  ASSERT_NE(at, std::string::npos) << told;
  EXPECT_EQ(told.find("dye", told.find('\n', at)), std::string::npos) << told;
  EXPECT_NE(told.find("--spectral"), std::string::npos) << told;
  words.push_back("--spectral");
  const Outcome spectral = penumbra(words);
  EXPECT_EQ(spectral.code, 0);
  EXPECT_EQ(spectral.err.find("dye"), std::string::npos) << spectral.err;
}

TEST(SpectralCommand, ABakeOverBandsTellsThatMirrorsPassNoLight) {
  const Workshop shop;
  const auto told = [&](const char* scene) {
    return penumbra({"bake", scene, "--spectral", "--elements", "60", "-o", shop.path("b.csv")}).err;
  };
  EXPECT_NE(told("builtin:cornell-spheres").find("mirrors and glass"), std::string::npos);
  EXPECT_EQ(told("builtin:furnace").find("mirrors and glass"), std::string::npos);
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
