// Pictures taken while things move, against how long each point is covered.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "penumbra/parallel/parallel_for.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

Mat4d shifted(const Vec3d& by) { return glm::translate(Mat4d(1.0), by); }

Material unlit(const Rgb& colour) {
  Material m = matt(colour);
  m.unlit = true;
  return m;
}

RenderOptions with(IntegratorKind kind, int samples) {
  RenderOptions options = whitted(samples);
  options.integrator = kind;
  return options;
}

/// How much of [0, 1] a point at x is covered by [a + way t, b + way t] as t goes from 0 to 1.
double covered(double x, double a, double b, double way) {
  const double enters = std::clamp((x - b) / way, 0.0, 1.0);
  const double leaves = std::clamp((x - a) / way, 0.0, 1.0);
  return leaves - enters;
}

double mean_covered(double from, double to, double a, double b, double way) {
  double sum = 0;
  for (int k = 0; k < 400; ++k) sum += covered(from + (k + 0.5) / 400 * (to - from), a, b, way) / 400;
  return sum;
}

TEST(MotionBlur, ASmallQuadIsAsBrightAsItStaysLong) {
  Scene scene;
  scene.environment = Environment{.radiance = Rgb(0), .image = std::nullopt};
  add_mesh(scene, rectangle({-1.5, -2, 0}, {0.4, 0, 0}, {0, 4, 0}), unlit(Rgb(1)));
  scene.instances[0].motion = {Mat4d(1.0), shifted({2.2, 0, 0})};
  const RayTracer tracer(scene);
  Camera camera{.name = "", .to_world = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}), .lens = OrthographicLens{4.0 / 32}};
  for (const IntegratorKind kind : {IntegratorKind::appel, IntegratorKind::whitted, IntegratorKind::path}) {
    RenderOptions options = with(kind, 1024);
    options.width = 32;
    options.height = 1;
    const Image image = render(tracer, camera, options).image;
    double sum = 0;
    for (int x = 0; x < 32; ++x) {
      const double from = -2 + x / 8.0;
      EXPECT_NEAR(image.pixel(x, 0)[1], mean_covered(from, from + 0.125, -1.5, -1.1, 2.2), 0.01) << x;
      sum += static_cast<double>(image.pixel(x, 0)[1]) / 8;
    }
    EXPECT_NEAR(sum, 0.4, 1e-3);  // nothing is lost by moving
  }
}

// A blocker passes between a point light and a floor: rays to the light have the time of the eye's.
TEST(MotionBlur, ShadowsMoveWithTheirObjects) {
  Scene scene;
  add_mesh(scene, rectangle({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}), matt(Rgb(0.5F)));
  add_mesh(scene, rectangle({-2, 1, 2}, {0.5, 0, 0}, {0, 0, -4}), matt(Rgb(0)));
  scene.instances[1].motion = {Mat4d(1.0), shifted({3, 0, 0})};
  DirectionalLight sun;
  sun.direction = {0, -1, 0};
  sun.irradiance = Rgb(2);
  scene.lights.push_back({"", sun});
  const RayTracer tracer(scene);
  // Low and from the side, so that the eye sees the floor and never the blocker's way.
  Camera camera{
      .name = "", .to_world = look_at({-0.2, 0.5, 3.9}, {-0.2, 0, 0}, {0, 1, 0}), .lens = PerspectiveLens{0.02}};
  for (const IntegratorKind kind : {IntegratorKind::appel, IntegratorKind::whitted, IntegratorKind::path}) {
    RenderOptions options = with(kind, 1024);
    options.width = options.height = 1;
    const Image image = render(tracer, camera, options).image;
    const double lit = 0.5 / pi * 2;
    EXPECT_NEAR(image.pixel(0, 0)[1], lit * (1 - covered(-0.2, -2, -1.5, 3)), 0.01 * lit) << static_cast<int>(kind);
  }
}

Scene still_life() {
  Scene scene;
  scene.environment = Environment{.radiance = Rgb(0.7F), .image = std::nullopt};
  add_mesh(scene, rectangle({-1, -1, 0}, {1, 0, 0}, {0, 1, 0}), unlit(Rgb(1, 0.5F, 0.2F)));
  add_mesh(scene, rectangle({0.2, 0.1, -0.5}, {0.7, 0.1, 0.3}, {0, 0.6, 0}), unlit(Rgb(0.1F, 0.3F, 0.9F)));
  return scene;
}

double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::pow(static_cast<double>(a.data[i] - b.data[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.data.size()));
}

TEST(MotionBlur, AMovingCameraIsAWorldThatMovesTheOtherWay) {
  const auto ways = {std::function<Mat4d(double)>([](double t) {
                       return shifted({0.8 * t, -0.3 * t, 0.5 * t});
                     }),
                     std::function<Mat4d(double)>([](double t) {
                       return glm::rotate(shifted({0.1 * t, 0, 0}), 0.4 * t, normalize(Vec3d(0.2, 1, 0.1)));
                     })};
  const Mat4d start = look_at({0.3, 0.2, 4}, {0, 0, 0}, {0, 1, 0});
  for (const auto& way : ways) {
    Scene world = still_life();
    Camera moving{.name = "", .to_world = start, .lens = PerspectiveLens{0.7}};
    Camera still = moving;
    moving.motion = sampled_motion([&](double t) { return way(t) * start; });
    for (Instance& instance : world.instances) {
      instance.motion = sampled_motion([&](double t) { return glm::inverse(way(t)); });
    }
    const Scene rest = still_life();
    const RayTracer tracer(rest);
    const RayTracer world_tracer(world);
    RenderOptions options = whitted(64);
    options.width = 40;
    options.height = 30;
    const Image by_camera = render(tracer, moving, options).image;
    const Image by_world = render(world_tracer, still, options).image;
    EXPECT_LT(rms(by_camera, by_world), 2e-3);
    EXPECT_GT(rms(by_camera, render(tracer, still, options).image), 0.02);  // and it does move
  }
}

// What the eye does not see moving changes no expectation; only other random numbers are drawn.
TEST(MotionBlur, WhatStandsStillLooksAsWithoutAShutter) {
  Scene timed = still_life();
  add_mesh(timed, rectangle({50, 50, 50}, {1, 0, 0}, {0, 1, 0}), unlit(Rgb(1)));
  const Scene still = timed;
  timed.instances.back().motion = {Mat4d(1.0), shifted({1, 0, 0})};
  const RayTracer a(timed);
  const RayTracer b(still);
  const Camera camera{
      .name = "", .to_world = look_at({0.3, 0.2, 4}, {0, 0, 0}, {0, 1, 0}), .lens = PerspectiveLens{0.7}};
  for (const IntegratorKind kind : {IntegratorKind::appel, IntegratorKind::whitted, IntegratorKind::path}) {
    RenderOptions options = with(kind, 256);
    options.width = 24;
    options.height = 18;
    const Image with_shutter = render(a, camera, options).image;
    const Image without = render(b, camera, options).image;
    EXPECT_LT(rms(with_shutter, without), 6e-3) << static_cast<int>(kind);
    // One sample a pixel goes through its middle, in the middle of the exposure.
    options.samples_per_pixel = 1;
    EXPECT_EQ(rms(render(a, camera, options).image, render(b, camera, options).image), 0);
  }
}

TEST(MotionBlur, IsTheSameOnAnyNumberOfThreadsThreaded) {
  Scene scene = still_life();
  scene.instances[0].motion = sampled_motion([](double t) { return glm::rotate(Mat4d(1.0), t, Vec3d(0, 0, 1)); });
  const RayTracer tracer(scene);
  Camera camera{.name = "", .to_world = look_at({0.3, 0.2, 4}, {0, 0, 0}, {0, 1, 0}), .lens = PerspectiveLens{0.7}};
  camera.motion = {camera.to_world, shifted({0.1, 0, 0}) * camera.to_world};
  for (const IntegratorKind kind : {IntegratorKind::appel, IntegratorKind::whitted, IntegratorKind::path}) {
    RenderOptions options = with(kind, 4);
    options.width = 40;
    options.height = 36;
    std::vector<float> first;
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      const Image image = render(tracer, camera, options).image;
      if (first.empty()) first = image.data;
      EXPECT_EQ(first, image.data) << threads;
    }
  }
}

}  // namespace
}  // namespace penumbra
