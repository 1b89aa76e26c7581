// Particles from the lights: the picture that path tracing draws, and what the notes' thought experiment counts.

#include "penumbra/render/light_tracing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

Camera looking(const Vec3d& eye, const Vec3d& at, double fov) {
  return {.name = "", .to_world = look_at(eye, at, Vec3d(0, 1, 0)), .lens = PerspectiveLens{fov}};
}

RenderOptions particles(int side, int samples) {
  RenderOptions options;
  options.integrator = IntegratorKind::light;
  options.width = options.height = side;
  options.samples_per_pixel = samples;
  return options;
}

/// Mean and standard error of the middle pixel of 3 x 3, from independent pictures.
Seen middle(const RayTracer& tracer, const Camera& camera, int samples) {
  constexpr int seeds = 12;
  double mean = 0, squares = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    RenderOptions options = particles(3, samples);
    options.seed = static_cast<std::uint64_t>(seed);
    const double value = render(tracer, camera, options).image.pixel(1, 1)[1];
    mean += value / seeds;
    squares += value * value / seeds;
  }
  Seen seen;
  seen.value = mean;
  seen.error = std::sqrt(std::max(0.0, squares - mean * mean) / (seeds - 1));
  return seen;
}

void expect_light(const RayTracer& tracer, const Camera& camera, double truth, const char* what, int samples = 3000) {
  const Seen seen = middle(tracer, camera, samples);
  EXPECT_NEAR(seen.value, truth, 4 * seen.error) << what;
  EXPECT_LT(seen.error, 0.08 * truth) << what;
}

/// A square of 2 m whose front looks up, in the middle.
Mesh plate() { return rectangle({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}); }

TEST(LightTracing, ALampOverAPlate) {
  Scene scene;
  add_mesh(scene, plate(), matt(Rgb(0.6F)));
  add_shape(scene, Disk{{0, 2, 0}, {0, -1, 0}, 0.8}, glow(Rgb(5)));
  const RayTracer tracer(scene);
  const double irradiance = pi * 5 * 0.64 / (0.64 + 4);
  expect_light(tracer, looking({0, 1, 2}, {0, 0, 0}, 0.3), 0.6 / pi * irradiance, "plate");
  expect_light(tracer, looking({0, 0.5, 0.6}, {0.1, 2, 0}, 0.3), 5, "lamp");
}

TEST(LightTracing, LightsWithoutABody) {
  const auto seen_with = [](const Light& light) {
    Scene scene;
    add_mesh(scene, plate(), matt(Rgb(0.6F)));
    scene.lights.push_back(light);
    return scene;
  };
  const Camera camera = looking({0, 1.2, 0.5}, {0, 0, 0}, 0.3);
  PointLight point;
  point.position = {0.5, 2, 0};
  point.intensity = Rgb(7);
  const Scene by_point = seen_with({"", point});
  const double d2 = 4.25;
  expect_light(RayTracer(by_point), camera, 0.6 / pi * 7 / d2 * 2 / std::sqrt(d2), "point");
  point.range = 3;
  const Scene by_range = seen_with({"", point});
  expect_light(RayTracer(by_range), camera, 0.6 / pi * 7 / d2 * 2 / std::sqrt(d2) * range_window(std::sqrt(d2), 3),
               "range");
  SpotLight spot;
  spot.position = {0, 2, 0};
  spot.direction = {0, -1, 0};
  spot.intensity = Rgb(7);
  spot.inner_angle = 0.4;
  spot.outer_angle = 0.5;
  const Scene by_spot = seen_with({"", spot});
  expect_light(RayTracer(by_spot), camera, 0.6 / pi * 7 / 4, "spot");
  const Scene by_sun = seen_with({"", DirectionalLight{normalize(Vec3d(1, -1, 0)), Rgb(3)}});
  expect_light(RayTracer(by_sun), camera, 0.6 / pi * 3 / std::sqrt(2.0), "sun");
  DirectionalLight wide{normalize(Vec3d(1, -1, 0)), Rgb(3)};
  wide.angular_radius = 0.2;
  const Scene by_wide_sun = seen_with({"", wide});
  expect_light(RayTracer(by_wide_sun), camera, 0.6 / pi * 3 / std::sqrt(2.0), "wide sun");
  PointLight luminaire = point;
  luminaire.range = std::numeric_limits<double>::infinity();
  luminaire.web = WebPlacement{};
  Scene by_web = seen_with({"", luminaire});
  by_web.webs.push_back({"", {0, 90}, {0}, {2, 0}});  // fades evenly to the side
  const double away = std::atan2(0.5, 2) / (pi / 2);
  expect_light(RayTracer(by_web), camera, 2 * (1 - away) * 0.6 / pi * 7 / d2 * 2 / std::sqrt(d2), "web");
}

TEST(LightTracing, ASky) {
  Scene scene;
  add_mesh(scene, plate(), matt(Rgb(0.6F)));
  scene.environment = Environment{};
  scene.environment->radiance = Rgb(0.5F);
  const RayTracer tracer(scene);
  expect_light(tracer, looking({0, 1, 2}, {0, 0, 0}, 0.3), 0.6 * 0.5, "plate");
  expect_light(tracer, looking({0, 1, 2}, {0, 3, 0}, 0.3), 0.5, "sky");
}

/// How far a picture from the lights is from a picture from the eye, block of 8 x 8 pixels by block: the largest
/// difference in standard errors.
double largest_deviation(
    const Scene& scene, const Camera& camera, int path_samples, int light_samples,
    const std::function<bool(int, int)>& counts = [](int, int) { return true; }) {
  constexpr int side = 32, block = 8, blocks = side / block, seeds = 10;
  const RayTracer tracer(scene);
  std::vector<double> mean(2 * blocks * blocks), squares(mean.size());
  for (int seed = 0; seed < seeds; ++seed) {
    for (const bool light : {false, true}) {
      RenderOptions options = particles(side, light ? light_samples : path_samples);
      options.integrator = light ? IntegratorKind::light : IntegratorKind::path;
      options.seed = static_cast<std::uint64_t>(seed);
      const Image image = render(tracer, camera, options).image;
      for (int b = 0; b < blocks * blocks; ++b) {
        double sum = 0;
        for (int k = 0; k < block * block; ++k) {
          const int x = b % blocks * block + k % block, y = b / blocks * block + k / block;
          if (counts(x, y)) sum += luminance(image.rgb(x, y));
        }
        const std::size_t at = static_cast<std::size_t>(2 * b + (light ? 1 : 0));
        mean[at] += sum / seeds;
        squares[at] += sum * sum / seeds;
      }
    }
  }
  double worst = 0;
  for (std::size_t i = 0; i < mean.size(); i += 2) {
    const double variance = (squares[i] - mean[i] * mean[i] + squares[i + 1] - mean[i + 1] * mean[i + 1]) / (seeds - 1);
    if (mean[i] > 0) worst = std::max(worst, std::abs(mean[i] - mean[i + 1]) / std::sqrt(variance));
  }
  return worst;
}

TEST(LightTracing, DrawsTheCornellBoxAsPathTracingDoes) {
  const Scene scene = make_builtin_scene("cornell-box");
  EXPECT_LT(largest_deviation(scene, scene.cameras.at(0), 16, 16), 5);
}

// Gloss, interpolated normals, a blended sheet and a coloured lamp.
TEST(LightTracing, DrawsGlossAndRoundedFacesAsPathTracingDoes) {
  Scene scene;
  Material glossy = matt({0.3F, 0.5F, 0.2F});
  glossy.specular = 1;
  glossy.roughness = 0.4F;
  add_mesh(scene, rectangle({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), glossy);
  Mesh ball = geodesic_sphere({0, 0.6, 0}, 0.6, 2);
  for (const Vec3d& p : ball.positions) ball.normals.push_back(Vec3f(normalize(p - Vec3d(0, 0.6, 0))));
  add_mesh(scene, ball, matt({0.7F, 0.3F, 0.3F}));
  Material sheet = matt({0.2F, 0.6F, 0.6F});
  sheet.alpha = 0.5F;
  sheet.alpha_mode = AlphaMode::blend;
  add_mesh(scene, rectangle({0.7, 0.1, 0.4}, {0.8, 0, 0.3}, {0, 1, 0}), sheet);
  add_mesh(scene, rectangle({-1, 3, -1}, {1, 0, 0}, {0, 0, 1}), glow({9, 7, 4}));
  EXPECT_LT(largest_deviation(scene, looking({0, 1.6, 4}, {0, 0.4, 0}, 0.8), 32, 32), 5);
}

// A glass ball out of the picture throws a caustic on the floor that the eye sees.
TEST(LightTracingSlow, ThrowsTheCausticsThatPathTracingFinds) {
  Scene scene;
  add_mesh(scene, rectangle({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), matt(Rgb(0.6F)));
  add_shape(scene, Sphere{{0, 1, 0}, 0.5}, glass(1.5F));
  add_mesh(scene, rectangle({-1.4, 3, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}), glow(Rgb(10)));
  const Camera camera = looking({2.5, 1.2, 0.2}, {0.5, 0, 0}, 0.35);
  EXPECT_LT(largest_deviation(scene, camera, 1024, 256), 5);
  Scene dull = scene;
  dull.materials[1] = matt(Rgb(0));
  const RenderResult with = render(RayTracer(scene), camera, particles(32, 64));
  const RenderResult without = render(RayTracer(dull), camera, particles(32, 64));
  double brightest = 0, plain = 0;
  for (std::size_t i = 0; i < with.image.data.size(); ++i) {
    brightest = std::max<double>(brightest, with.image.data[i]);
    plain = std::max<double>(plain, without.image.data[i]);
  }
  EXPECT_GT(brightest, 1.5 * plain);
}

// A small lamp sends the share r^2 / d^2 of its light into a pupil of radius r at distance d on its axis.
TEST(LightTracing, CountsWhatMeetsTheEyeByItself) {
  Scene scene;
  constexpr double d = 0.04, r = ParticleFates::pupil_radius;
  add_shape(scene, Disk{{0, 0, 0}, {0, 0, 1}, 1e-5}, glow(Rgb(1)));
  const RayTracer tracer(scene);
  const RenderResult result = render(tracer, looking({0, 0, d}, {0, 0, 0}, 1.0), particles(64, 64));
  ASSERT_TRUE(result.particles);
  const double shot = 64.0 * 64 * 64;
  EXPECT_EQ(result.particles->shot, static_cast<std::uint64_t>(shot));
  EXPECT_EQ(result.particles->seen, 0U);  // they meet no surface
  const double share = r * r / (d * d + r * r);
  EXPECT_NEAR(static_cast<double>(result.particles->met_eye), shot * share, 4 * std::sqrt(shot * share));
  // Looking away it meets none.
  const RenderResult away = render(tracer, looking({0, 0, d}, {0, 0, 1}, 1.0), particles(64, 4));
  EXPECT_EQ(away.particles->met_eye, 0U);
  // A wall behind the eye, which it does not see; then a wall that it does.
  add_mesh(scene, rectangle({-9, -9, 2}, {0, 18, 0}, {18, 0, 0}), matt(Rgb(0.5F)));
  const RayTracer walled(scene);
  EXPECT_EQ(render(walled, looking({0, 0, d}, {0, 0, 0}, 1.0), particles(64, 4)).particles->seen, 0U);
  const ParticleFates fates = *render(walled, looking({0, 0, d}, {0, 0, 1}, 2.5), particles(64, 4)).particles;
  EXPECT_GT(fates.seen, fates.shot / 2);
  EXPECT_LE(fates.seen, fates.shot);
}

TEST(LightTracingThreaded, TheSameBitsOnAnyNumberOfThreads) {
  const Scene scene = make_builtin_scene("cornell-spheres");
  const RayTracer tracer(scene);
  const auto draw = [&](int threads) {
    const ThreadLimit limit(threads);
    return render(tracer, scene.cameras.at(0), particles(40, 20));
  };
  const RenderResult one = draw(1);
  for (const int threads : {2, 8}) {
    const RenderResult many = draw(threads);
    EXPECT_EQ(many.image.data, one.image.data);
    EXPECT_EQ(many.rays.by_depth, one.rays.by_depth);
    EXPECT_EQ(many.particles->seen, one.particles->seen);
  }
}

TEST(LightTracing, ARegionIsAPartOfTheWholePicture) {
  const Scene scene = make_builtin_scene("cornell-box");
  const RayTracer tracer(scene);
  RenderOptions options = particles(16, 16);
  const Image whole = render(tracer, scene.cameras.at(0), options).image;
  options.region = Region{3, 4, 11, 9};
  const Image part = render(tracer, scene.cameras.at(0), options).image;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const bool inside = x >= 3 && x < 11 && y >= 4 && y < 9;
      EXPECT_EQ(part.rgb(x, y), inside ? whole.rgb(x, y) : Rgb(0));
    }
  }
}

TEST(LightTracing, WhatCannotBeCountedIsRefused) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  scene.lights.push_back({"", DirectionalLight{}});
  const Camera camera = looking({0, 1, 1}, {0, 0, 0}, 1);
  EXPECT_THROW((void)render(RayTracer(scene), camera, particles(4, 1)), std::invalid_argument);
  scene.lights[0].kind = PointLight{.inverse_square = false};
  EXPECT_THROW((void)render(RayTracer(scene), camera, particles(4, 1)), std::invalid_argument);
  scene.lights[0].kind = PointLight{};
  EXPECT_NO_THROW((void)render(RayTracer(scene), camera, particles(4, 1)));
  Camera panorama = camera;
  panorama.lens = PanoramicLens{};
  EXPECT_THROW((void)render(RayTracer(scene), panorama, particles(4, 1)), std::invalid_argument);
  Scene foggy = scene;
  foggy.media.push_back({.name = "fog", .scattering = Rgb(0.1F)});
  foggy.air = {0};
  EXPECT_THROW((void)render(RayTracer(foggy), camera, particles(4, 1)), std::invalid_argument);
  scene.lights.clear();
  EXPECT_EQ(render(RayTracer(scene), camera, particles(4, 1)).particles->shot, 0U);
}

}  // namespace
}  // namespace penumbra
