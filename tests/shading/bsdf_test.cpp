#include "penumbra/tracing/shading/bsdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/tracing/shading/fresnel.h"
#include "shading/sphere_statistics.h"

namespace penumbra {
namespace {

using std::numbers::pi;

const Vec3d up(0, 0, 1);

Bsdf flat(const SurfaceMaterial& material) { return {material, Frame(up), up}; }

Vec3d direction(double cos_theta, double phi = 0.4) {
  const double sine = std::sqrt(1 - cos_theta * cos_theta);
  return {sine * std::cos(phi), sine * std::sin(phi), cos_theta};
}

SurfaceMaterial lambert(const Rgb& colour) {
  SurfaceMaterial m;
  m.base_colour = colour;
  m.specular = 0;
  return m;
}

SurfaceMaterial glass(float roughness = 0) {
  SurfaceMaterial m;
  m.base_colour = Rgb(1);
  m.transmission = 1;
  m.roughness = roughness;
  return m;
}

SurfaceMaterial metal(const Rgb& colour, float roughness) {
  SurfaceMaterial m;
  m.base_colour = colour;
  m.metallic = 1;
  m.roughness = roughness;
  return m;
}

std::string describe(const SurfaceMaterial& m) {
  return "metallic " + std::to_string(m.metallic) + " roughness " + std::to_string(m.roughness) + " specular " +
         std::to_string(m.specular) + " ior " + std::to_string(m.ior) + " transmission " +
         std::to_string(m.transmission) + " thin " + std::to_string(m.thin_walled) + " mirror " +
         std::to_string(m.mirror.x) + " conductor " + std::to_string(m.conductor.has_value());
}

/// Any material, the extremes of each property as often as what lies between.
SurfaceMaterial random_material(CounterRng& rng) {
  const auto share = [&] {
    const double u = rng.next();
    return static_cast<float>(u < 0.25 ? 0.0 : (u > 0.75 ? 1.0 : 2 * u - 0.5));
  };
  SurfaceMaterial m;
  m.base_colour = {share(), share(), share()};
  m.metallic = share();
  m.roughness = static_cast<float>(0.2 + 0.8 * rng.next());
  m.specular = share();
  m.specular_colour = {2 * share(), share(), share()};
  m.ior = rng.next() < 0.1 ? 0.0F : static_cast<float>(1 + rng.next() * 1.5);
  m.transmission = share();
  m.thin_walled = rng.next() < 0.3;
  if (rng.next() < 0.2) m.mirror = {share(), share(), share()};
  if (rng.next() < 0.3) m.conductor = ConductorIor{{0.2F, 0.9F, 1.5F}, {3.0F, 2.5F, 7.0F}};
  return m;
}

/// Directions from which light reaches wo, weighed: what a furnace of radiance 1 shows.
struct Furnace {
  Vec3d ideal{0};
  Vec3d spread{0};
};

Furnace furnace_by_quadrature(const Bsdf& bsdf, const Vec3d& wo, int steps) {
  const SpecularSplit ideal = bsdf.specular_split(wo, -1);  // only what is ideal in itself
  Furnace f;
  f.ideal = Vec3d(ideal.reflected) + Vec3d(ideal.refracted);
  f.spread =
      integrate_over_sphere(steps, [&](const Vec3d& wi) { return Vec3d(bsdf.evaluate(wo, wi)) * std::abs(wi.z); });
  return f;
}

/// The same by the weights of samples, on a lattice of low discrepancy (Roberts's, by the root of x^4 = x + 1).
Furnace furnace_by_sampling(const Bsdf& bsdf, const Vec3d& wo, int trials) {
  constexpr double root = 1.2207440846057596;
  Furnace f;
  for (int i = 0; i < trials; ++i) {
    const auto coordinate = [&](double a) { return std::fmod(0.5 + i * a, 1.0); };
    const auto s =
        bsdf.sample(wo, coordinate(1 / root), {coordinate(1 / (root * root)), coordinate(1 / (root * root * root))});
    if (s) (s->ideal ? f.ideal : f.spread) += Vec3d(s->weight) / static_cast<double>(trials);
  }
  return f;
}

void expect_same(const Vec3d& a, const Vec3d& b, double tolerance) {
  for (int band = 0; band < 3; ++band) EXPECT_NEAR(a[band], b[band], tolerance) << "band " << band;
}

TEST(Bsdf, LambertIsExactlyBaseOverPi) {
  const Rgb colour(0.8F, 0.3F, 0.1F);
  const Bsdf bsdf = flat(lambert(colour));
  CounterRng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const double u = rng.next();
    const Vec3d wo = sample_cosine_hemisphere({u, rng.next()});
    const double v = rng.next();
    const auto s = bsdf.sample(wo, rng.next(), {v, rng.next()});
    ASSERT_TRUE(s);
    EXPECT_EQ(bsdf.evaluate(wo, s->direction), colour / std::numbers::pi_v<float>);
    EXPECT_EQ(s->weight, colour);
    EXPECT_NEAR(s->pdf, s->direction.z / pi, 1e-15);
    EXPECT_NEAR(bsdf.pdf(wo, s->direction), s->pdf, 1e-15);
    EXPECT_FALSE(s->ideal);
    EXPECT_FALSE(s->transmitted);
  }
  EXPECT_EQ(bsdf.diffuse_reflectance(), colour);
  EXPECT_TRUE(bsdf.has_spread());
  const SpecularSplit split = bsdf.specular_split(direction(0.5), 1);
  EXPECT_TRUE(is_black(split.reflected));
  EXPECT_TRUE(is_black(split.refracted));
  EXPECT_EQ(bsdf.evaluate_unsplit(direction(0.5), up, 1), colour / std::numbers::pi_v<float>);
}

/// f(wo, wi) n_wo^2 = f(wi, wo) n_wi^2, as radiance is stored divided by the index squared: for reflection, plain
/// reciprocity.
TEST(Bsdf, IsReciprocal) {
  CounterRng rng(2);
  int lit = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const SurfaceMaterial m = random_material(rng);
    const double u = rng.next();
    Vec3d n = sample_sphere({u, rng.next()});
    const double v = rng.next();
    const Vec3d tilted = glm::normalize(n + 0.4 * sample_sphere({v, rng.next()}));
    const Bsdf bsdf(m, Frame(tilted), n);
    for (int pair = 0; pair < 8; ++pair) {
      const double a = rng.next();
      const Vec3d wo = sample_sphere({a, rng.next()});
      const double b = rng.next();
      const Vec3d wi = sample_sphere({b, rng.next()});
      const auto index = [&](const Vec3d& w) { return m.thin_walled || glm::dot(w, n) > 0 ? 1.0 : m.ior; };
      const bool crossing = (glm::dot(wo, n) > 0) != (glm::dot(wi, n) > 0);
      const double scale_o = crossing ? index(wo) * index(wo) : 1;
      const double scale_i = crossing ? index(wi) * index(wi) : 1;
      const Vec3d there = Vec3d(bsdf.evaluate(wo, wi)) * scale_o;
      const Vec3d back = Vec3d(bsdf.evaluate(wi, wo)) * scale_i;
      lit += there.x + there.y + there.z > 0 ? 1 : 0;
      for (int band = 0; band < 3; ++band) {
        ASSERT_NEAR(there[band], back[band], 1e-6 * there[band] + 1e-9) << describe(m) << " crossing " << crossing;
      }
    }
  }
  EXPECT_GT(lit, 5000);
}

TEST(Bsdf, NeverReflectsMoreThanArrives) {
  CounterRng rng(3);
  for (int trial = 0; trial < 150; ++trial) {
    SurfaceMaterial m = random_material(rng);
    m.base_colour = Rgb(1);  // the most that can be
    if (trial % 2 == 0) m.roughness = static_cast<float>(rng.next() * 0.3);
    if (trial % 3 == 0) m.roughness = 0;
    const Bsdf bsdf = flat(m);
    for (const double cos_theta : {0.05, 0.3, 0.7, 1.0}) {
      for (const double side : {1.0, -1.0}) {
        const Furnace f = furnace_by_sampling(bsdf, side * direction(cos_theta), 3000);
        for (int band = 0; band < 3; ++band) {
          EXPECT_LE(f.ideal[band] + f.spread[band], 1.01) << describe(m) << " cos " << side * cos_theta;
        }
      }
    }
  }
}

/// The white furnace: what the layer does not reflect, a white base under it does, at every angle and roughness.
// In a furnace a white metal of any roughness is not to be seen.
TEST(Bsdf, AWhiteMetalLosesNothing) {
  for (const float roughness : {0.2F, 0.4F, 0.6F, 0.8F, 1.0F}) {
    const Bsdf bsdf = flat(metal(Rgb(1), roughness));
    for (const double cosine : {0.1, 0.3, 0.6, 1.0}) {
      const Furnace f = furnace_by_quadrature(bsdf, direction(cosine), 512);
      EXPECT_NEAR(f.spread.x, 1, 6e-3) << roughness << " " << cosine;
    }
  }
}

// Coloured metals grow more saturated as they grow rougher: light that bounces twice is tinted twice.
TEST(Bsdf, RoughMetalsAreTintedMoreNotLess) {
  const Rgb gold(1.0F, 0.7F, 0.3F);
  const Furnace smooth = furnace_by_quadrature(flat(metal(gold, 0.3F)), direction(0.7), 512);
  const Furnace rough = furnace_by_quadrature(flat(metal(gold, 1.0F)), direction(0.7), 512);
  EXPECT_NEAR(rough.spread.x, 1, 6e-3);
  EXPECT_LT(rough.spread.z / rough.spread.x, smooth.spread.z / smooth.spread.x);
}

TEST(Bsdf, AWhiteBaseUnderALayerLosesNothing) {
  for (const float ior : {1.0F, 1.33F, 1.5F, 2.5F}) {
    for (const float specular : {0.3F, 1.0F}) {
      for (const float roughness : {0.0F, 0.25F, 0.4F, 0.7F, 1.0F}) {
        SurfaceMaterial m;
        m.base_colour = Rgb(1);
        m.ior = ior;
        m.specular = specular;
        m.roughness = roughness;
        for (const double cos_theta : {0.1, 0.4, 0.8, 1.0}) {
          const Furnace f = furnace_by_sampling(flat(m), direction(cos_theta), 10'000);
          EXPECT_NEAR(f.ideal.x + f.spread.x, 1, 5e-3) << describe(m) << " cos " << cos_theta;
        }
      }
    }
  }
}

TEST(Bsdf, SampledWeightsMeetTheIntegral) {
  CounterRng rng(4);
  for (int trial = 0; trial < 40; ++trial) {
    SurfaceMaterial m = random_material(rng);
    m.roughness = std::max(m.roughness, 0.3F);
    const Bsdf bsdf = flat(m);
    const Vec3d wo = (trial % 2 == 0 ? 1.0 : -1.0) * direction(0.15 + 0.85 * rng.next());
    SCOPED_TRACE(describe(m) + " cos " + std::to_string(wo.z));
    const Furnace sampled = furnace_by_sampling(bsdf, wo, 40'000);
    const Furnace integral = furnace_by_quadrature(bsdf, wo, 128);
    expect_same(sampled.ideal, integral.ideal, 2e-3);
    expect_same(sampled.spread, integral.spread, 6e-3);
  }
}

TEST(Bsdf, SamplesFollowTheirDensity) {
  CounterRng rng(5);
  for (int trial = 0; trial < 24; ++trial) {
    SurfaceMaterial m = random_material(rng);
    m.roughness = std::max(m.roughness, 0.4F);
    const Bsdf bsdf = flat(m);
    const Vec3d wo = (trial % 2 == 0 ? 1.0 : -1.0) * direction(0.1 + 0.9 * rng.next());
    SphereHistogram histogram(12);
    constexpr int trials = 50'000;
    for (int i = 0; i < trials; ++i) {
      const double lobe = rng.next();
      const double u = rng.next();
      const auto s = bsdf.sample(wo, lobe, {u, rng.next()});
      if (s && !s->ideal) histogram.add(s->direction);
    }
    EXPECT_LT(histogram.deviate(trials, [&](const Vec3d& wi) { return bsdf.pdf(wo, wi); }), 4.5)
        << describe(m) << " cos " << wo.z;
  }
}

TEST(Bsdf, ASampleAgreesWithEvaluateAndPdf) {
  CounterRng rng(6);
  for (int trial = 0; trial < 5000; ++trial) {
    const SurfaceMaterial m = random_material(rng);
    const double t = rng.next();
    const Vec3d tilted = glm::normalize(up + 0.4 * sample_sphere({t, rng.next()}));
    const Frame frame(tilted);
    const Bsdf bsdf(m, frame, up);
    const double u = rng.next();
    const Vec3d wo = sample_sphere({u, rng.next()});
    const double lobe = rng.next();
    const double v = rng.next();
    const auto s = bsdf.sample(wo, lobe, {v, rng.next()});
    if (!s) continue;
    EXPECT_NEAR(glm::length(s->direction), 1, 1e-12);
    EXPECT_EQ(s->transmitted, wo.z * s->direction.z < 0);
    EXPECT_EQ(s->ideal, s->pdf == 0);
    if (s->ideal) continue;
    EXPECT_NEAR(bsdf.pdf(wo, s->direction), s->pdf, 1e-6 * s->pdf) << describe(m);
    const Vec3d weight = Vec3d(bsdf.evaluate(wo, s->direction)) * std::abs(glm::dot(s->direction, tilted)) / s->pdf;
    for (int band = 0; band < 3; ++band) {
      EXPECT_NEAR(weight[band], s->weight[band], 1e-5 * weight[band] + 1e-9) << describe(m);
    }
  }
}

TEST(Bsdf, SmoothGlassFollowsSnellAndFresnelAndLosesNothing) {
  const Bsdf bsdf = flat(glass());
  EXPECT_FALSE(bsdf.has_spread());
  for (int i = 1; i <= 50; ++i) {
    for (const double side : {1.0, -1.0}) {
      const Vec3d wo = side * direction(i / 50.0);
      const double from = side > 0 ? 1 : 1.5;
      const double to = side > 0 ? 1.5 : 1;
      const double r = fresnel_dielectric(i / 50.0, from, to).mean();
      const SpecularSplit split = bsdf.specular_split(wo, 0.1);
      EXPECT_NEAR(split.reflected.x, r, 1e-6);
      EXPECT_NEAR(split.refracted.x, 1 - r, 1e-6);
      EXPECT_LT(glm::distance(split.reflection_direction, reflect(wo, up)), 1e-12);
      if (const auto beyond = refract(wo, side * up, from, to)) {
        EXPECT_LT(glm::distance(split.refraction_direction, *beyond), 1e-12);
      } else {
        EXPECT_EQ(split.reflected, Rgb(1));
        EXPECT_EQ(split.refracted, Rgb(0));
      }
      for (const double u : {0.01, 0.5, 0.99}) {
        const auto s = bsdf.sample(wo, u, {0.3, 0.6});
        ASSERT_TRUE(s);
        EXPECT_TRUE(s->ideal);
        EXPECT_NEAR(s->weight.x, 1, 1e-6);
        EXPECT_LT(glm::distance(s->direction, s->transmitted ? split.refraction_direction : split.reflection_direction),
                  1e-12);
      }
    }
  }
}

TEST(Bsdf, RoughGlassTendsToSmooth) {
  const Bsdf bsdf = flat(glass(0.04F));
  ASSERT_TRUE(bsdf.has_spread());
  for (const double cos_theta : {0.3, 0.6, 0.9}) {
    for (const double side : {1.0, -1.0}) {
      const Vec3d wo = side * direction(cos_theta);
      const double r = fresnel_dielectric(cos_theta, side > 0 ? 1 : 1.5, side > 0 ? 1.5 : 1).mean();
      double reflected = 0;
      double transmitted = 0;
      constexpr int trials = 20'000;
      CounterRng rng(7);
      for (int i = 0; i < trials; ++i) {
        const double lobe = rng.next();
        const double u = rng.next();
        if (const auto s = bsdf.sample(wo, lobe, {u, rng.next()})) {
          (s->transmitted ? transmitted : reflected) += static_cast<double>(s->weight.x) / trials;
        }
      }
      EXPECT_NEAR(reflected, r, 0.02) << cos_theta * side;
      EXPECT_NEAR(transmitted, 1 - r, 0.02) << cos_theta * side;
    }
  }
}

/// Solid and thin glass of any roughness.
std::vector<SurfaceMaterial> rough_glasses() {
  std::vector<SurfaceMaterial> all;
  for (const float roughness : {0.3F, 0.5F, 0.8F, 1.0F}) {
    for (const float ior : {1.2F, 1.5F, 2.4F}) {
      SurfaceMaterial m = glass(roughness);
      m.ior = ior;
      all.push_back(m);
      m.thin_walled = true;
      all.push_back(m);
    }
  }
  return all;
}

/// A furnace of basic radiance 1 on both sides: clear glass is not to be seen, from outside and from inside. The mean
/// over the hemisphere by projected solid angle, at angles each of which is within `each` of 1.
double furnace_of_glass(const SurfaceMaterial& m, double side, int trials, double each) {
  const Bsdf bsdf = flat(m);
  double mean = 0, weights = 0;
  for (const double cosine : {0.05, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0}) {
    const Furnace f = furnace_by_sampling(bsdf, side * direction(cosine), trials);
    EXPECT_NEAR(f.ideal.x + f.spread.x, 1, each) << describe(m) << " cos " << side * cosine;
    mean += cosine * (f.ideal.x + f.spread.x);
    weights += cosine;
  }
  return mean / weights;
}

TEST(Bsdf, RoughGlassLosesNothing) {
  for (const SurfaceMaterial& m : rough_glasses()) {
    if (m.ior != 1.5F || (m.roughness != 0.5F && m.roughness != 1)) continue;
    for (const double side : {1.0, -1.0}) EXPECT_NEAR(furnace_of_glass(m, side, 20'000, 1.5e-2), 1, 5e-3);
  }
}

// To a thousandth; the albedo of thin plates comes from a coarser table.
TEST(BsdfSlow, RoughGlassLosesNotAThousandth) {
  for (const SurfaceMaterial& m : rough_glasses()) {
    if (m.ior < 1.3F || (m.roughness != 0.5F && m.roughness != 1)) continue;
    for (const double side : {1.0, -1.0}) {
      EXPECT_NEAR(furnace_of_glass(m, side, m.thin_walled ? 100'000 : 400'000, 8e-3), 1, m.thin_walled ? 2.5e-3 : 1e-3)
          << describe(m) << " side " << side;
    }
  }
}

TEST(Bsdf, RoughGlassIsReciprocalAcrossItsSurface) {
  CounterRng rng(12);
  for (const SurfaceMaterial& m : rough_glasses()) {
    const Bsdf bsdf = flat(m);
    int crossed = 0;
    for (int k = 0; k < 400; ++k) {
      const double a = rng.next();
      const Vec3d wo = sample_sphere({a, rng.next()});
      const double b = rng.next();
      const Vec3d wi = sample_sphere({b, rng.next()});
      const auto index = [&](const Vec3d& w) { return m.thin_walled || w.z > 0 ? 1.0 : static_cast<double>(m.ior); };
      const bool crossing = wo.z * wi.z < 0;
      const double there = bsdf.evaluate(wo, wi).x * (crossing ? index(wo) * index(wo) : 1);
      const double back = bsdf.evaluate(wi, wo).x * (crossing ? index(wi) * index(wi) : 1);
      ASSERT_NEAR(there, back, 1e-5 * there + 1e-9) << describe(m);
      crossed += crossing && there > 0 ? 1 : 0;
    }
    EXPECT_GT(crossed, 100);
  }
}

TEST(Bsdf, SamplesOfRoughGlassFollowTheirDensity) {
  CounterRng rng(13);
  for (const SurfaceMaterial& m : rough_glasses()) {
    if (m.ior != 1.5F || m.roughness < 0.4F || m.roughness > 0.9F) continue;
    const Bsdf bsdf = flat(m);
    // Not at grazing angles from outside: the density then rises too steeply at the limit of refraction to be summed
    // over the histogram's cells.
    for (const double cosine : {0.9, 0.6, -0.7, -0.3}) {
      const Vec3d wo = (cosine > 0 ? 1.0 : -1.0) * direction(std::abs(cosine));
      SphereHistogram histogram(12);
      constexpr int trials = 50'000;
      for (int i = 0; i < trials; ++i) {
        const double lobe = rng.next();
        const double u = rng.next();
        const auto s = bsdf.sample(wo, lobe, {u, rng.next()});
        if (s) histogram.add(s->direction);
      }
      EXPECT_LT(histogram.deviate(trials, [&](const Vec3d& wi) { return bsdf.pdf(wo, wi); }), 4.5)
          << describe(m) << " cos " << cosine;
    }
  }
}

TEST(Bsdf, AThinPlateSumsItsBouncesAndBendsNothing) {
  SurfaceMaterial m = glass();
  m.thin_walled = true;
  for (const double cos_theta : {0.05, 0.5, 1.0}) {
    for (const double side : {1.0, -1.0}) {
      const Vec3d wo = side * direction(cos_theta);
      const SpecularSplit split = flat(m).specular_split(wo, 0);
      const double r = fresnel_dielectric(cos_theta, 1, 1.5).mean();
      EXPECT_NEAR(split.reflected.x, 2 * r / (1 + r), 1e-6);
      EXPECT_NEAR(split.refracted.x, (1 - r) / (1 + r), 1e-6);
      EXPECT_LT(glm::distance(split.refraction_direction, -wo), 1e-12);
    }
  }
}

TEST(Bsdf, TheTintOfGlassColoursWhatPassesOnly) {
  SurfaceMaterial m = glass();
  m.base_colour = {0.5F, 0.25F, 0};
  const SpecularSplit clear = flat(glass()).specular_split(direction(0.6), 0);
  const SpecularSplit tinted = flat(m).specular_split(direction(0.6), 0);
  EXPECT_EQ(tinted.reflected, clear.reflected);
  expect_same(tinted.refracted, Vec3d(clear.refracted) * Vec3d(m.base_colour), 1e-6);
}

/// Reflected + refracted + diffuse = 1 for what absorbs nothing, whatever the shares.
TEST(Bsdf, WhittedsSplitAccountsForAllLight) {
  for (const float roughness : {0.0F, 0.05F, 0.1F}) {
    for (const float transmission : {0.0F, 0.3F, 1.0F}) {
      for (const float metallic : {0.0F, 0.5F}) {
        SurfaceMaterial m;
        m.base_colour = Rgb(1);
        m.roughness = roughness;
        m.transmission = transmission;
        m.metallic = metallic;
        const Bsdf bsdf = flat(m);
        for (const double cos_theta : {0.1, 0.5, 1.0}) {
          const Vec3d wo = direction(cos_theta);
          const SpecularSplit split = bsdf.specular_split(wo, 0.1);
          const double rest = integrate_over_sphere(
              200, [&](const Vec3d& wi) { return bsdf.evaluate_unsplit(wo, wi, 0.1).x * std::abs(wi.z); });
          EXPECT_NEAR(split.reflected.x + split.refracted.x + rest, 1, 1e-3) << describe(m) << " cos " << cos_theta;
        }
      }
    }
  }
}

TEST(Bsdf, WhatIsTooRoughToSplitStaysWhole) {
  CounterRng rng(8);
  for (int trial = 0; trial < 500; ++trial) {
    SurfaceMaterial m = random_material(rng);
    m.mirror = Rgb(0);
    m.ior = std::max(m.ior, 1.1F);  // without contrast glass passes rays straight at any roughness
    const Bsdf bsdf = flat(m);
    const double u = rng.next();
    const Vec3d wo = sample_sphere({u, rng.next()});
    const double v = rng.next();
    const Vec3d wi = sample_sphere({v, rng.next()});
    const SpecularSplit split = bsdf.specular_split(wo, 0.1);
    EXPECT_TRUE(is_black(split.reflected));
    EXPECT_TRUE(is_black(split.refracted));
    EXPECT_EQ(bsdf.evaluate_unsplit(wo, wi, 0.1), bsdf.evaluate(wo, wi));
  }
}

TEST(Bsdf, MirrorAddsToTheMattUntilAllIsReflected) {
  SurfaceMaterial m = lambert({0.8F, 0.5F, 0.1F});
  m.mirror = Rgb(0.2F);
  const Rgb f = flat(m).evaluate(direction(0.5), up);
  expect_same(f, Vec3d(m.base_colour) / pi, 1e-6);
  EXPECT_EQ(flat(m).specular_split(direction(0.1), 0).reflected, m.mirror);
  m.mirror = Rgb(0.6F);  // 0.8 + 0.6 would shine
  expect_same(flat(m).evaluate(direction(0.5), up), Vec3d(0.4, 0.4, 0.1) / pi, 1e-6);
  const Furnace f2 = furnace_by_sampling(flat(m), direction(0.5), 20'000);
  expect_same(f2.ideal + f2.spread, {1, 1, 0.7}, 2e-3);
}

TEST(Bsdf, MetalsReflectTheirFresnelTerm) {
  const Rgb gold(1.0F, 0.78F, 0.34F);
  EXPECT_EQ(flat(metal(gold, 0)).specular_split(up, 0).reflected, gold);
  SurfaceMaterial exact = metal(gold, 0);
  exact.conductor = ConductorIor{{0.25F, 0.5F, 1.5F}, {3, 2.5F, 1.9F}};
  for (const double c : {0.1, 0.5, 1.0}) {
    const Rgb r = flat(exact).specular_split(direction(c), 0).reflected;
    for (int band = 0; band < 3; ++band) {
      EXPECT_NEAR(r[band], fresnel_conductor(c, exact.conductor->eta[band], exact.conductor->k[band]).mean(), 1e-6);
    }
  }
}

TEST(Bsdf, AnIndexOfZeroReflectsAll) {
  SurfaceMaterial m;
  m.ior = 0;
  for (const float transmission : {0.0F, 0.5F, 1.0F}) {
    m.transmission = transmission;
    m.roughness = 0;
    const SpecularSplit split = flat(m).specular_split(direction(0.7), 0);
    EXPECT_NEAR(split.reflected.x, 1, 1e-6);
    EXPECT_EQ(split.refracted, Rgb(0));
    EXPECT_EQ(flat(m).evaluate(up, direction(0.5)), Rgb(0));
    m.roughness = 0.5F;
    for (const double side : {1.0, -1.0}) {
      const Furnace f = furnace_by_sampling(flat(m), side * direction(0.7), 2000);
      EXPECT_LE(f.spread.x, 1.001);
      EXPECT_GT(f.spread.x, 0.8);
    }
  }
}

TEST(Bsdf, OpaqueSurfacesReflectOnBothSidesAlike) {
  CounterRng rng(9);
  for (int trial = 0; trial < 500; ++trial) {
    SurfaceMaterial m = random_material(rng);
    m.transmission = 0;
    const double u = rng.next();
    const Vec3d wo = sample_sphere({u, rng.next()});
    const double v = rng.next();
    const Vec3d wi = sample_sphere({v, rng.next()});
    const Vec3d through(1, 1, -1);
    const Rgb f = flat(m).evaluate(wo, wi);
    EXPECT_EQ(f, flat(m).evaluate(wo * through, wi * through));
    EXPECT_EQ(flat(m).pdf(wo, wi), flat(m).pdf(wo * through, wi * through));
    if (wo.z * wi.z < 0) {
      EXPECT_EQ(f, Rgb(0));
    }
  }
}

TEST(Bsdf, BentShadingNormalsLetNoLightThrough) {
  CounterRng rng(10);
  for (int trial = 0; trial < 3000; ++trial) {
    SurfaceMaterial m = random_material(rng);
    m.transmission = 0;
    const double t = rng.next();
    const Vec3d tilted = glm::normalize(up + 0.9 * sample_sphere({t, rng.next()}));
    const Bsdf bsdf(m, Frame(tilted), up);
    const double u = rng.next();
    const Vec3d wo = sample_sphere({u, rng.next()});
    const double v = rng.next();
    const Vec3d wi = sample_sphere({v, rng.next()});
    if (wo.z * wi.z < 0) {
      EXPECT_EQ(bsdf.evaluate(wo, wi), Rgb(0));
    }
    const double lobe = rng.next();
    const double w = rng.next();
    if (const auto s = bsdf.sample(wo, lobe, {w, rng.next()})) {
      EXPECT_GT(s->direction.z * wo.z, 0);
    }
    const SpecularSplit split = bsdf.specular_split(wo, 1);
    if (!is_black(split.reflected)) {
      EXPECT_GT(split.reflection_direction.z * wo.z, 0);
    }
  }
}

TEST(Bsdf, GrazingAndDegenerateDirectionsGiveNumbers) {
  CounterRng rng(11);
  for (int trial = 0; trial < 2000; ++trial) {
    SurfaceMaterial m = random_material(rng);
    if (trial % 2 == 0) m.roughness = 0.032F;  // the narrowest that is not ideal
    const Bsdf bsdf = flat(m);
    for (const double c : {0.0, 1e-300, 1e-12, 1e-5, 1.0}) {
      for (const Vec3d& wo : {direction(c), -direction(c)}) {
        for (const Vec3d& wi : {direction(c), -direction(c), reflect(direction(c), up), direction(1)}) {
          const Rgb f = bsdf.evaluate(wo, wi);
          EXPECT_TRUE(std::isfinite(f.x + f.y + f.z)) << describe(m) << ' ' << c;
          EXPECT_TRUE(std::isfinite(bsdf.pdf(wo, wi))) << describe(m) << ' ' << c;
        }
        const double lobe = rng.next();
        if (const auto s = bsdf.sample(wo, lobe, {0, 0})) {
          EXPECT_TRUE(std::isfinite(s->weight.x + s->weight.y + s->weight.z + s->pdf)) << describe(m) << ' ' << c;
          EXPECT_GE(s->weight.x, 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
