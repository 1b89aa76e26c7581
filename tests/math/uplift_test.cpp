#include "penumbra/math/uplift.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "penumbra/math/cie_colour.h"
#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

/// What a surface with the uplifted reflectance looks like in light of the uplifted colour.
Vec3d seen(const Vec3d& reflectance, const Vec3d& light) {
  Vec3d sum(0);
  for (double nm = 380.25; nm < 780; nm += 0.5) {
    const Vec3d basis = uplift_basis(nm);
    sum += 0.5 * white_radiance(nm) * dot(light, basis) * dot(reflectance, basis) * rec709_matching(nm);
  }
  return sum;
}

TEST(Uplift, BasisIsAPartitionOfOneWithinBounds) {
  for (double nm = 300; nm < 900; nm += 0.3) {
    const Vec3d basis = uplift_basis(nm);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(basis[k], -1e-12);
      EXPECT_LE(basis[k], 1 + 1e-12);
    }
    EXPECT_NEAR(basis.x + basis.y + basis.z, 1, 1e-12);
  }
}

TEST(Uplift, ReflectanceUnderWhiteLightIsTheColourAgain) {
  CounterRng rng(1);
  for (int n = 0; n < 50; ++n) {
    const Vec3d colour(rng.next(), rng.next(), rng.next());
    const Vec3d back = seen(colour, Vec3d(1));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(back[k], colour[k], 3e-5);
  }
}

TEST(Uplift, EmissionOfAnyStrengthIsTheColourAgain) {
  for (const Vec3d light : {Vec3d(17, 12, 4), Vec3d(0, 0, 1e4), Vec3d(1e-3, 0, 0), Vec3d(0, 3, 3)}) {
    const Vec3d back = seen(Vec3d(1), light);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(back[k], light[k], 3e-5 * std::max({light.x, light.y, light.z}));
  }
}

// Never more than the brightest band, so never beyond energy.
TEST(Uplift, ReflectanceStaysBetweenItsBands) {
  CounterRng rng(2);
  for (int n = 0; n < 100; ++n) {
    const Vec3d c(rng.next(), rng.next(), rng.next());
    const auto [least, most] = std::minmax({c.x, c.y, c.z});
    for (double nm = 380; nm <= 780; nm += 1) {
      const double r = dot(c, uplift_basis(nm));
      EXPECT_GE(r, least - 1e-9);
      EXPECT_LE(r, most + 1e-9);
    }
  }
}

// No edge steeper than a third of the whole in 10 nm.
TEST(Uplift, SpectraAreSmooth) {
  for (double nm = 380; nm < 770; nm += 1) {
    const Vec3d step = uplift_basis(nm + 10) - uplift_basis(nm);
    for (int k = 0; k < 3; ++k) EXPECT_LT(std::abs(step[k]), 1.0 / 3);
  }
}

// Light reflected twice is what RGB cannot say: red on red is redder in a spectrum than the product of the numbers.
TEST(Uplift, InterreflectionDiffersFromProductsOfNumbers) {
  const Vec3d paint(0.63, 0.065, 0.05);
  const Vec3d twice = seen(paint, paint);
  EXPECT_GT(std::abs(twice.x / (paint.x * paint.x) - 1), 0.003);
}

}  // namespace
}  // namespace penumbra
