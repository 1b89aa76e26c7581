#include "penumbra/tracing/shading/microfacet.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "shading/sphere_statistics.h"

namespace penumbra {
namespace {

Vec3d direction(double cos_theta, double phi = 0.7) {
  const double sine = std::sqrt(1 - cos_theta * cos_theta);
  return {sine * std::cos(phi), sine * std::sin(phi), cos_theta};
}

TEST(Ggx, ProjectedMicrofacetAreaIsTheSurface) {
  for (const double alpha : {0.01, 0.05, 0.2, 0.5, 1.0}) {
    const Ggx ggx(alpha);
    constexpr int steps = 100'000;  // of the polar angle; the azimuth does not matter
    double area = 0;
    for (int i = 0; i < steps; ++i) {
      const double theta = (i + 0.5) * std::numbers::pi / 2 / steps;
      const Vec3d h(std::sin(theta), 0, std::cos(theta));
      area += 2 * std::numbers::pi * ggx.distribution(h) * h.z * h.x * std::numbers::pi / 2 / steps;
    }
    EXPECT_NEAR(area, 1, 1e-6) << alpha;
  }
}

/// What a direction sees of the microfacets is what it sees of the flat surface (Heitz 2014, eq. 14).
TEST(Ggx, VisibleMicrofacetAreaIsTheProjectedSurface) {
  for (const double alpha : {0.1, 0.4, 1.0}) {
    for (const double cos_theta : {0.1, 0.5, 0.9}) {
      const Ggx ggx(alpha);
      const Vec3d w = direction(cos_theta);
      const double seen = integrate_over_sphere(
          512, [&](const Vec3d& h) { return ggx.masking(w) * ggx.distribution(h) * std::max(0.0, glm::dot(w, h)); });
      EXPECT_NEAR(seen, cos_theta, 1e-3 * cos_theta) << alpha << ' ' << cos_theta;
    }
  }
}

TEST(Ggx, MaskingIsAShareAndCorrelationHidesLess) {
  CounterRng rng(1);
  for (int i = 0; i < 2000; ++i) {
    const Ggx ggx(1e-3 + rng.next());
    const Vec3d a = direction(rng.next() + 1e-9);
    const Vec3d b = direction(rng.next() + 1e-9, 6 * rng.next());
    const double both = ggx.masking_shadowing(a, b);
    EXPECT_GE(both, 0);
    EXPECT_GE(both, ggx.masking(a) * ggx.masking(b) * (1 - 1e-12));
    EXPECT_LE(both, std::min(ggx.masking(a), ggx.masking(b)));
    EXPECT_LE(ggx.masking(a), 1);
    EXPECT_EQ(both, ggx.masking_shadowing(b, a));
  }
}

TEST(Ggx, EndsAreRight) {
  EXPECT_EQ(Ggx(0.5).masking({0, 0, 1}), 1);
  EXPECT_EQ(Ggx(0.5).masking({1, 0, 0}), 0);
  EXPECT_EQ(Ggx(0.5).distribution({0, 0, -1}), 0);
  EXPECT_NEAR(Ggx(1).distribution(direction(0.3)), 1 / std::numbers::pi, 1e-12);  // a hemisphere has all normals alike
  EXPECT_NEAR(Ggx(0.01).distribution({0, 0, 1}), 1e4 / std::numbers::pi, 1e-6);
}

TEST(Ggx, VisibleNormalsFollowTheirDensity) {
  for (const double alpha : {0.1, 0.5, 1.0}) {
    for (const double cos_theta : {0.05, 0.5, 1.0}) {
      const Ggx ggx(alpha);
      const Vec3d w = direction(cos_theta);
      SphereHistogram histogram(24);
      CounterRng rng(hash_key(7, static_cast<int>(1000 * alpha + 10 * cos_theta)));
      constexpr int trials = 100'000;
      for (int i = 0; i < trials; ++i) {
        const double u = rng.next();
        const Vec3d h = ggx.sample_visible_normal(w, {u, rng.next()});
        ASSERT_NEAR(glm::length(h), 1, 1e-12);
        ASSERT_GE(glm::dot(w, h), -1e-12);
        histogram.add(h);
      }
      EXPECT_LT(histogram.deviate(trials, [&](const Vec3d& h) { return ggx.visible_normal_pdf(w, h); }), 4.5)
          << alpha << ' ' << cos_theta;
    }
  }
}

}  // namespace
}  // namespace penumbra
