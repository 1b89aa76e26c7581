#include "penumbra/math/bands.h"

#include <gtest/gtest.h>

#include "penumbra/math/cie_colour.h"

namespace penumbra {
namespace {

/// Mean over n evenly spaced heroes.
template <class Light>
Vec3d mean_colour(int n, const Light& light) {
  Vec3d sum(0);
  for (int i = 0; i < n; ++i) {
    const Bands bands = Bands::sample((i + 0.5) / n);
    sum += Vec3d(bands.to_rgb(light(bands))) / double(n);
  }
  return sum;
}

TEST(Bands, RgbLeavesEverythingAsItIs) {
  const Bands rgb;
  const Rgb c(0.1F, 0.7F, 30.0F);
  EXPECT_FALSE(rgb.spectral());
  EXPECT_EQ(rgb.reflectance(c), c);
  EXPECT_EQ(rgb.emission(c), c);
  EXPECT_EQ(rgb.to_rgb(c), c);
}

TEST(Bands, WavelengthsAreVisibleAndAThirdOfTheDensityApart) {
  for (int i = 0; i < 1000; ++i) {
    const double u = i / 1000.0;
    const auto w = Bands::sample(u).wavelengths();
    for (const double nm : w) {
      EXPECT_GE(nm, shortest_visible);
      EXPECT_LE(nm, longest_visible);
    }
    const auto next = Bands::sample(std::fmod(u + 1 / 3.0, 1.0)).wavelengths();
    EXPECT_NEAR(next[0], w[1], 1e-6);
    EXPECT_NEAR(next[1], w[2], 1e-6);
  }
}

TEST(Bands, ASurfaceInLightKeepsItsRgbColour) {
  for (const Rgb paint : {Rgb(1), Rgb(0.63F, 0.065F, 0.05F), Rgb(0, 1, 0), Rgb(0.05F, 0.1F, 0.9F)}) {
    const Vec3d seen = mean_colour(4096, [&](const Bands& b) { return b.reflectance(paint) * b.emission(Rgb(1)); });
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], paint[k], 1e-3 * std::max(0.1F, paint[k]));
    const Vec3d lit = mean_colour(4096, [&](const Bands& b) { return b.emission(20.0F * paint); });
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(lit[k], 20 * paint[k], 2e-2 * std::max(0.1F, paint[k]));
  }
}

// When a path disperses the hero goes on alone, for all three.
TEST(Bands, TheHeroAloneHasTheSameMean) {
  const Vec3d seen = mean_colour(4096, [](const Bands& b) {
    const Rgb light = b.emission(Rgb(0.2F, 0.5F, 0.9F));
    return Rgb(3 * light.x, 0, 0);
  });
  EXPECT_NEAR(seen.x, 0.2, 1e-3);
  EXPECT_NEAR(seen.y, 0.5, 1e-3);
  EXPECT_NEAR(seen.z, 0.9, 1e-3);
}

TEST(Bands, OneSampleOfWhiteIsNearlyWhite) {
  Vec3d square(0);
  constexpr int n = 4096;
  for (int i = 0; i < n; ++i) {
    const Bands bands = Bands::sample((i + 0.5) / n);
    const Vec3d off = Vec3d(bands.to_rgb(bands.emission(Rgb(1)))) - Vec3d(1);
    square += off * off / double(n);
  }
  for (int k = 0; k < 3; ++k) EXPECT_LT(std::sqrt(square[k]), 0.08);
}

TEST(Bands, ShiftedComponentsLookTheirNewWavelengthsUp) {
  const Bands bands = Bands::sample(0.3);
  const Bands shifted = bands.shifted_to({350, 450, 600});
  EXPECT_EQ(shifted.emission(Rgb(1)).x, 0) << "RGB white holds no ultraviolet";
  EXPECT_NEAR(shifted.emission(Rgb(1)).y, white_radiance(450), 1e-8);
  EXPECT_EQ(shifted.to_rgb(Rgb(1)), bands.to_rgb(Rgb(1)));
}

}  // namespace
}  // namespace penumbra
