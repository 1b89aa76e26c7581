// Mirrors and glass as Whitted's recursion and path tracing see them, against Snell, Fresnel and Beer-Lambert.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "penumbra/tracing/shading/fresnel.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

/// A ceiling whose pattern tells where it was met: a chequer of two radiances, squares of 1 m, seen from below.
Scene chequered_ceiling() {
  Scene scene;
  Material pattern;
  pattern.unlit = true;
  pattern.base_colour = {0.9F, 0.2F, 0.4F};
  pattern.checker_colour = Rgb(0.1F, 0.6F, 0.3F);
  add_plane(scene, {0, 3, 0}, {0, -1, 0}, pattern);
  return scene;
}

bool near_a_line(const Vec3d& p) {
  const auto off = [](double x) { return std::abs(x - std::round(x)); };
  return off(p.x) < 1e-3 || off(p.z) < 1e-3;
}

TEST(Whitted, AMirrorShowsTheMirroredWorld) {
  const Scene plain = chequered_ceiling();
  Scene mirrored = plain;
  add_plane(mirrored, {0, 0, 0}, {0, 1, 0}, mirror(Rgb(0.8F)));
  const RayTracer open(plain), closed(mirrored);
  Dice dice(1);
  int patterns = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3d eye(dice.between(-2, 2), dice.between(0.1, 2), dice.between(-2, 2));
    Vec3d down = dice.direction();
    down.y = -std::abs(down.y) - 0.1;
    down = normalize(down);
    const Vec3d image_eye(eye.x, -eye.y, eye.z), up(down.x, -down.y, down.z);
    if (near_a_line(image_eye + (3 - image_eye.y) / up.y * up)) continue;
    const Rgb seen = look(closed, eye, down, whitted()).radiance;
    const Rgb truth = 0.8F * look(open, image_eye, up, whitted()).radiance;
    ASSERT_LT(length(seen - truth), 1e-5F);
    patterns += seen.x > 0.5F ? 1 : 0;
  }
  EXPECT_GT(patterns, 50);
}

TEST(Optics, ASphereOfIndexOneIsInvisible) {
  const Scene plain = chequered_ceiling();
  Scene with_ball = plain;
  add_shape(with_ball, Sphere{{0, 1, 0}, 1}, glass(1));
  const RayTracer open(plain), closed(with_ball);
  Dice dice(2);
  for (int n = 0; n < 300; ++n) {
    const Vec3d eye(dice.between(-2, 2), -1, dice.between(-2, 2));
    const Vec3d way = normalize(Vec3d(0, 1, 0) + dice.cube(0.7) - eye);
    if (way.y < 0.1 || near_a_line(eye + (4 / way.y) * way)) continue;
    const Rgb truth = look(open, eye, way, whitted()).radiance;
    ASSERT_LT(length(look(closed, eye, way, whitted()).radiance - truth), 1e-5F);
    ASSERT_LT(length(look(closed, eye, way, path(1)).radiance - truth), 1e-5F);
  }
}

// The eye stands in water under a bright sky, above a ground of another brightness.
TEST(Optics, TotalReflectionBeyondTheCriticalAngle) {
  Scene scene;
  scene.environment = Environment{};
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, glass(1.5F));
  Material ground;
  ground.unlit = true;
  ground.base_colour = Rgb(0.7F);
  add_plane(scene, {0, -3, 0}, {0, 1, 0}, ground);
  const RayTracer tracer(scene);
  for (const double degrees : {0.0, 20.0, 30.0, 41.0, 42.0, 60.0, 85.0}) {
    const double a = degrees * pi / 180;
    const double reflected = fresnel_dielectric(std::cos(a), 1.5, 1).mean();
    if (degrees > 41.9) {
      ASSERT_EQ(reflected, 1);
    }
    const double truth = reflected * 0.7 + (1 - reflected) * 1;
    const Vec3d up(std::sin(a), std::cos(a), 0);
    EXPECT_NEAR(look(tracer, {0, -1, 0}, up, whitted()).value, truth, 1e-4) << degrees;
    const Seen p = look(tracer, {0, -1, 0}, up, path(1024));
    EXPECT_NEAR(p.value, truth, 3 * p.error + 1e-4) << degrees;
  }
}

TEST(Optics, ClearGlassInAnEvenWorldIsInvisible) {
  for (const bool ball : {true, false}) {
    Scene scene;
    scene.environment = Environment{};
    if (ball) {
      add_shape(scene, Sphere{{0, 0, 0}, 1}, glass(1.5F));
    } else {
      add_mesh(scene, box({-2, -0.1, -2}, {2, 0.1, 2}), glass(1.5F));
    }
    const RayTracer tracer(scene);
    Dice dice(3);
    double sum = 0, variance = 0;
    for (int n = 0; n < 100; ++n) {
      const Vec3d eye = 4.0 * dice.direction();
      const Vec3d way = normalize(0.6 * dice.direction() - eye);
      ASSERT_NEAR(look(tracer, eye, way, whitted()).value, 1, 1e-3) << (ball ? "ball" : "plate");
      const Seen p = look(tracer, eye, way, path(64));
      sum += p.value;
      variance += p.error * p.error;
    }
    // Long paths inside end by Russian roulette: the mean is right.
    EXPECT_NEAR(sum, 100, 3 * std::sqrt(variance)) << (ball ? "ball" : "plate");
    EXPECT_LT(std::sqrt(variance), 1);
  }
}

TEST(Optics, NoPartOfTheWorldIsLostAtOneSurface) {
  // Reflection + refraction = 1, seen as a mirror image in one colour and a view through in another.
  Scene scene;
  Material red, green;
  red.unlit = green.unlit = true;
  red.base_colour = {1, 0, 0};
  green.base_colour = {0, 1, 0};
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, glass(1.33F));
  add_plane(scene, {0, 5, 0}, {0, -1, 0}, red);
  add_plane(scene, {0, -5, 0}, {0, 1, 0}, green);
  const RayTracer tracer(scene);
  for (const double degrees : {0.0, 10.0, 45.0, 53.06, 70.0, 85.0}) {
    const double a = degrees * pi / 180;
    const Rgb seen = look(tracer, {0, 1, 0}, {std::sin(a), -std::cos(a), 0}, whitted()).radiance;
    EXPECT_NEAR(seen.x, fresnel_dielectric(std::cos(a), 1, 1.33F).mean(), 1e-6) << degrees;
    EXPECT_NEAR(seen.x + seen.y, 1, 1e-6) << degrees;
  }
}

/// A slab of glass 0.1 m thick over a lamp of radiance 1, black elsewhere.
Scene slab_over_lamp(const Material& material) {
  Scene scene;
  add_mesh(scene, box({-50, -0.1, -50}, {50, 0, 50}), material);
  add_plane(scene, {0, -1, 0}, {0, 1, 0}, glow(Rgb(1)));
  return scene;
}

// (1 - R)^2 t / (1 - R^2 t^2), every reflection inside the slab counted.
TEST(Optics, AColouredSlabHeadOn) {
  Material coloured = glass(1.5F);
  coloured.attenuation_colour = {0.2F, 0.5F, 0.9F};
  coloured.attenuation_distance = 0.1F;
  const Scene scene = slab_over_lamp(coloured);
  const RayTracer tracer(scene);
  const Seen w = look(tracer, {0.3, 2, 0.4}, {0, -1, 0}, whitted());
  const double r = 0.04;
  for (int c = 0; c < 3; ++c) {
    const double t = coloured.attenuation_colour[c];
    EXPECT_NEAR(w.radiance[c], (1 - r) * (1 - r) * t / (1 - r * r * t * t), 1e-4);
  }
  const double truth = (1 - r) * (1 - r) * 0.5 / (1 - r * r * 0.25);
  const Seen p = look(tracer, {0.3, 2, 0.4}, {0, -1, 0}, path(4096));
  EXPECT_NEAR(p.value, truth, 3 * p.error);
  EXPECT_LT(p.error, 0.01);
}

// Rays carry no polarisation: a rendered slab passes (1 - R)/(1 + R) with the unpolarised R.
TEST(Optics, AClearSlabPassesWhatUnpolarisedFresnelSays) {
  constexpr float index = 1.52F;
  const Scene scene = slab_over_lamp(glass(index));
  const RayTracer tracer(scene);
  for (const double degrees : {0.0, 30.0, 60.0}) {
    const double a = degrees * pi / 180;
    const double r = fresnel_dielectric(std::cos(a), 1, index).mean();
    const double truth = (1 - r) / (1 + r);
    const Vec3d way(std::sin(a), -std::cos(a), 0);
    EXPECT_NEAR(look(tracer, {0, 2, 0}, way, whitted()).value, truth, 1e-4) << degrees;
    const Seen p = look(tracer, {0, 2, 0}, way, path(4096));
    EXPECT_NEAR(p.value, truth, 3 * p.error) << degrees;
    EXPECT_LT(p.error, 0.01);
    // What docs/guide/rendering.md says of the gap to the mean of both polarisations.
    const double both = fresnel_plate(std::cos(a), index).transmittance;
    EXPECT_NEAR(truth / both, degrees == 60 ? 0.985 : 1, degrees == 60 ? 5e-4 : 1.5e-3);
  }
}

TEST(Optics, ThinPanesPassWhatAClearSlabDoes) {
  Material pane = glass(1.5F);
  pane.thin_walled = true;
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, pane);
  add_plane(scene, {0, -1, 0}, {0, 1, 0}, glow(Rgb(1)));
  const RayTracer tracer(scene);
  for (const double degrees : {0.0, 60.0}) {
    const double a = degrees * pi / 180;
    const double seen = look(tracer, {0, 2, 0}, {std::sin(a), -std::cos(a), 0}, whitted()).value;
    const double r = fresnel_dielectric(std::cos(a), 1, 1.5).mean();
    EXPECT_NEAR(seen, (1 - r) / (1 + r), 1e-5) << degrees;
  }
}

TEST(Optics, TheEyeInsideGlassSeesThroughIt) {
  Material coloured = glass(1.5F);
  coloured.attenuation_colour = Rgb(0.5F);
  coloured.attenuation_distance = 1;
  Scene scene;
  scene.environment = Environment{};
  add_shape(scene, Sphere{{0, 0, 0}, 1}, coloured);
  const RayTracer tracer(scene);
  // From the centre every ray meets the wall head on: 0.96 t out, the rest back through the whole ball, and so on.
  const double t = 0.5, through = 0.25, r = 0.04;
  const double truth = 0.96 * t / (1 - r * through);
  EXPECT_NEAR(look(tracer, {0, 0, 0}, {0.3, 0.5, 0.2}, whitted()).value, truth, 1e-4);
}

TEST(Whitted, TheTreeEndsAtItsDepth) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, mirror(Rgb(1)));
  add_plane(scene, {0, 1, 0}, {0, -1, 0}, mirror(Rgb(1)));
  const RayTracer tracer(scene);
  for (const int depth : {1, 5, 40}) {
    RenderOptions options = whitted();
    options.max_depth = depth;
    const RayCounts rays = look(tracer, {0, 0.5, 0}, {0.01, 1, 0}, options).rays;
    EXPECT_EQ(rays.primary, 1U);
    EXPECT_EQ(rays.reflection, static_cast<std::uint64_t>(depth));
    EXPECT_EQ(rays.by_depth.size(), static_cast<std::size_t>(depth) + 1);
  }
}

TEST(Whitted, TheTreeEndsWhereWeightsAreSmall) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, mirror(Rgb(0.5F)));
  add_plane(scene, {0, 1, 0}, {0, -1, 0}, mirror(Rgb(0.5F)));
  const RayTracer tracer(scene);
  RenderOptions options = whitted();
  options.min_throughput = 1e-3;
  EXPECT_EQ(look(tracer, {0, 0.5, 0}, {0.01, 1, 0}, options).rays.reflection, 9U);  // 2^-9 > 1e-3 > 2^-10
}

TEST(Path, DepthOneIsDirectLight) {
  Scene scene;
  scene.environment = Environment{};
  add_shape(scene, Sphere{{0, 0, 0}, 1}, matt(Rgb(0.5F)));
  add_plane(scene, {0, -1, 0}, {0, 1, 0}, matt(Rgb(0.8F)));
  const RayTracer tracer(scene);
  RenderOptions options = path(4096);
  options.max_depth = 1;
  // Straight down on the ball: half of pi L, the whole upper hemisphere.
  const Seen top = look(tracer, {0, 3, 0}, {0, -1, 0}, options);
  EXPECT_NEAR(top.value, 0.5, 4 * top.error + 1e-6);
  // On its side half of the hemisphere is ground, which is dark at this depth.
  const Seen side = look(tracer, {3, 0, 0}, {-1, 0, 0}, options);
  EXPECT_NEAR(side.value, 0.25, 4 * side.error + 1e-6);
  EXPECT_LT(side.error, 0.01);
}

}  // namespace
}  // namespace penumbra
