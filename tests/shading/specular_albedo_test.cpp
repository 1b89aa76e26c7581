#include "penumbra/tracing/shading/specular_albedo.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/tracing/shading/fresnel.h"
#include "penumbra/tracing/shading/microfacet.h"

namespace penumbra {
namespace {

/// The albedo by a lattice of visible normals (the plastic number's, of low discrepancy).
SpecularAlbedo by_quadrature(double roughness, double cos_theta) {
  constexpr int points = 16'384;
  const Ggx ggx(roughness * roughness);
  const Vec3d wo(std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta);
  SpecularAlbedo sum;
  for (int i = 0; i < points; ++i) {
    const Vec2d u(std::fmod(0.5 + i * 0.7548776662466927, 1), std::fmod(0.5 + i * 0.5698402909980532, 1));
    const Vec3d h = ggx.sample_visible_normal(wo, u);
    const Vec3d wi = reflect(wo, h);
    if (wi.z <= 0) continue;
    const double seen = ggx.masking_shadowing(wo, wi) / ggx.masking(wo);
    const double edge = fresnel_schlick(glm::dot(wo, h), 0, 1);
    sum.base += seen * (1 - edge) / points;
    sum.edge += seen * edge / points;
  }
  return sum;
}

TEST(SpecularAlbedo, IsTheIntegralOfTheLobe) {
  for (const double roughness : {0.05, 0.1, 0.22, 0.5, 0.77, 1.0}) {
    for (const double cos_theta : {0.02, 0.05, 0.1, 0.25, 0.5, 0.8, 1.0}) {
      const SpecularAlbedo table = specular_albedo(roughness, cos_theta);
      const SpecularAlbedo integral = by_quadrature(roughness, cos_theta);
      const double tolerance = cos_theta < 0.05 ? 0.01 : 0.002;
      EXPECT_NEAR(table.base, integral.base, tolerance) << roughness << ' ' << cos_theta;
      EXPECT_NEAR(table.edge, integral.edge, tolerance) << roughness << ' ' << cos_theta;
    }
  }
}

TEST(SpecularAlbedo, MeanIsTheIntegralOfTheTable) {
  for (const double roughness : {0.0, 0.1, 0.33, 1.0}) {
    SpecularAlbedo sum;
    constexpr int steps = 20'000;
    for (int i = 0; i < steps; ++i) {
      const double cos_theta = (i + 0.5) / steps;
      const SpecularAlbedo here = specular_albedo(roughness, cos_theta);
      sum.base += 2 * cos_theta * here.base / steps;
      sum.edge += 2 * cos_theta * here.edge / steps;
    }
    EXPECT_NEAR(specular_albedo_mean(roughness).base, sum.base, 1e-6);
    EXPECT_NEAR(specular_albedo_mean(roughness).edge, sum.edge, 1e-6);
  }
}

TEST(SpecularAlbedo, SmoothIsSchlick) {
  for (int i = 0; i <= 50; ++i) {
    const double c = i / 50.0;
    EXPECT_NEAR(specular_albedo(0, c).of(0.04, 1), fresnel_schlick(c, 0.04), 1e-3) << c;
  }
  EXPECT_NEAR(specular_albedo_mean(0).edge, 1 / 21.0, 3e-4);  // 2 integral of c (1 - c)^5
}

TEST(SpecularAlbedo, StrangeArgumentsAreClamped) {
  EXPECT_EQ(specular_albedo(2, 0.5).base, specular_albedo(1, 0.5).base);
  EXPECT_EQ(specular_albedo(0.5, 1 + 1e-9).base, specular_albedo(0.5, 1).base);
  EXPECT_EQ(specular_albedo(0.5, -1e-9).base, specular_albedo(0.5, 0).base);
}

}  // namespace
}  // namespace penumbra
