#include "penumbra/tracing/shading/rough_glass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/math/rng.h"
#include "penumbra/tracing/shading/fresnel.h"
#include "penumbra/tracing/shading/microfacet.h"

namespace penumbra {
namespace {

/// What leaves no facet, by a lattice of visible normals (the plastic number's, of low discrepancy).
double lost_by_quadrature(double roughness, double cos_theta, double from, double to) {
  constexpr int points = 16'384;
  const Ggx ggx(roughness * roughness);
  const Vec3d wo(std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta);
  double kept = 0;
  for (int i = 0; i < points; ++i) {
    const Vec2d u(std::fmod(0.5 + i * 0.7548776662466927, 1), std::fmod(0.5 + i * 0.5698402909980532, 1));
    const Vec3d h = ggx.sample_visible_normal(wo, u);
    const double fresnel = fresnel_dielectric(std::min(1.0, glm::dot(wo, h)), from, to).mean();
    const Vec3d mirrored = reflect(wo, h);
    if (mirrored.z > 0) kept += fresnel * ggx.masking_shadowing(wo, mirrored) / ggx.masking(wo) / points;
    const auto refracted = refract(wo, h, from, to);
    if (refracted && refracted->z < 0) kept += (1 - fresnel) * ggx.masking(*refracted) / points;
  }
  return 1 - kept;
}

TEST(RoughGlass, LosesWhatTheLobesDo) {
  CounterRng rng(1);
  double squares = 0;
  constexpr int trials = 120;
  for (int k = 0; k < trials; ++k) {
    const double roughness = 0.1 + 0.9 * rng.next(), ior = 1.15 + 1.4 * rng.next(), c = 0.03 + 0.97 * rng.next();
    const bool outside = k % 2 == 0;
    const double table = RoughGlass(roughness, ior).lost(outside, c);
    const double integral = lost_by_quadrature(roughness, c, outside ? 1 : ior, outside ? ior : 1);
    EXPECT_NEAR(table, integral, 6e-3) << roughness << ' ' << ior << ' ' << c << ' ' << outside;
    squares += (table - integral) * (table - integral) / trials;
  }
  EXPECT_LT(std::sqrt(squares), 1.2e-3);
}

TEST(RoughGlass, MeanIsTheIntegral) {
  for (const double roughness : {0.1, 0.4, 1.0}) {
    const RoughGlass glass(roughness, 1.5);
    for (const bool outside : {true, false}) {
      constexpr int steps = 20'000;
      double sum = 0;
      for (int i = 0; i < steps; ++i) {
        const double root = (i + 0.5) / steps;  // finer where it changes most
        sum += 4 * root * root * root * glass.lost(outside, root * root) / steps;
      }
      EXPECT_NEAR(glass.mean_lost(outside), sum, 5e-5);  // what is interpolated below 0 counts as 0 there
    }
  }
}

TEST(RoughGlass, GivesBackReciprocally) {
  for (const double ior : {1.1, 1.5, 2.5}) {
    for (const double roughness : {0.05, 0.5, 1.0}) {
      const RoughGlass glass(roughness, ior);
      const double there = (1 - glass.reflected(true)) * glass.mean_lost(true);
      const double back = ior * ior * (1 - glass.reflected(false)) * glass.mean_lost(false);
      EXPECT_NEAR(there, back, 1e-12);
      for (const bool outside : {true, false}) {
        EXPECT_GE(glass.reflected(outside), 0);
        EXPECT_LE(glass.reflected(outside), 1);
      }
    }
  }
}

TEST(RoughGlass, SmoothGlassLosesNothing) {
  const RoughGlass glass(0, 1.5);
  EXPECT_LT(glass.mean_lost(true), 1e-4);
  EXPECT_LT(glass.mean_lost(false), 1e-4);
  EXPECT_EQ(RoughGlass().lost(true, 0.5), 0);
}

}  // namespace
}  // namespace penumbra
