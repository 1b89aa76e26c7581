// Soft shadows by shadow rays sent where they are needed: fewer rays for the same noise, no bias, nothing missed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;

/// A scene, and what it is seen by.
struct Stage {
  Scene scene;
  Camera camera;
};

Camera looking(const Vec3d& eye, const Vec3d& at, double fov = 0.7) {
  return {.name = "", .to_world = look_at(eye, at, Vec3d(0, 1, 0)), .lens = PerspectiveLens{fov}};
}

Mesh square_lamp(const Vec3d& centre, double side) {
  const double h = side / 2;
  return rectangle(centre + Vec3d(-h, 0, -h), {side, 0, 0}, {0, 0, side});  // front down
}

/// A board held over a floor, under a square lamp: half of the picture is in even light or shadow.
Stage board() {
  Stage stage{{}, looking({0, 3, 4}, {0, 0, 0})};
  add_plane(stage.scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.6F)));
  add_mesh(stage.scene, rectangle({-0.7, 0.6, -0.7}, {0, 0, 1.4}, {1.4, 0, 0}), matt(Rgb(0.5F)));
  add_mesh(stage.scene, square_lamp({0.3, 4, -0.3}, 0.5), glow(Rgb(30)));
  return stage;
}

Stage balls_and_columns() {
  Stage stage{{}, looking({0, 2.5, 5}, {0, 0.5, 0})};
  add_plane(stage.scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.7F)));
  for (int i = -1; i <= 1; ++i) {
    add_shape(stage.scene, Sphere{{1.1 * i, 0.5, 0.3 * i}, 0.4}, matt({0.6F, 0.4F, 0.2F}));
    add_mesh(stage.scene, box({1.1 * i - 0.1, 0, -1.2}, {1.1 * i + 0.1, 1.4, -1}), matt(Rgb(0.5F)));
  }
  add_shape(stage.scene, Sphere{{1.5, 4, 1}, 0.4}, glow(Rgb(20)));
  return stage;
}

Stage fence_and_two_lamps() {
  Stage stage{{}, looking({0, 2.5, 4}, {0, 0, 0})};
  add_plane(stage.scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.7F)));
  for (int i = 0; i < 7; ++i) {
    add_mesh(stage.scene, box({0.4 * i - 1.25, 0, -0.05}, {0.4 * i - 1.15, 0.9, 0.05}), matt({0.3F, 0.5F, 0.3F}));
  }
  add_mesh(stage.scene, square_lamp({-1, 3, -2}, 0.4), glow({40, 20, 10}));
  add_shape(stage.scene, Disk{{1.5, 3.5, -1}, {0, -1, 0}, 0.3}, glow({10, 20, 40}));
  return stage;
}

Stage builtin(const char* name) {
  Stage stage{make_builtin_scene(name), {}};
  stage.camera = stage.scene.cameras.at(0);
  return stage;
}

RenderOptions picture(int side, int samples) {
  RenderOptions options;
  options.integrator = IntegratorKind::whitted;
  options.width = options.height = side;
  options.samples_per_pixel = samples;
  return options;
}

RenderOptions selective(RenderOptions options, int rays) {
  options.shadow_samples = rays;
  return options;
}

RenderOptions uniform(RenderOptions options, int rays) {
  options.shadow_samples = rays;
  options.shadow_samples_everywhere = true;
  return options;
}

/// Between pictures of the same camera rays, so that shadows alone make it.
double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::pow(static_cast<double>(a.data[i]) - b.data[i], 2);
  return std::sqrt(sum / static_cast<double>(a.data.size()));
}

/// The picture by so many rays everywhere that it costs at least `cost` rays.
RenderResult uniform_at_the_cost_of(std::uint64_t cost, const RayTracer& tracer, const Camera& camera,
                                    const RenderOptions& options) {
  for (int rays = 1;; ++rays) {
    RenderResult result = render(tracer, camera, uniform(options, rays));
    if (result.rays.total() >= cost) return result;
  }
}

TEST(SoftShadows, ThreeTimesFewerRaysForTheSameNoise) {
  const Stage stage = board();
  const RayTracer tracer(stage.scene);
  const RenderOptions options = picture(80, 1);
  RenderOptions exact = options;
  exact.exact_shadows = true;
  exact.shadow_samples = 2;  // the same camera rays and no lamp's middle
  const Image truth = render(tracer, stage.camera, exact).image;
  const RenderResult sparing = render(tracer, stage.camera, selective(options, 16));
  const double reached = rms(sparing.image, truth);
  EXPECT_GT(reached, 0);
  const RenderResult lavish = uniform_at_the_cost_of(3 * sparing.rays.total(), tracer, stage.camera, options);
  EXPECT_LE(reached, rms(lavish.image, truth));
  RecordProperty("rms_selective", std::to_string(reached));
  RecordProperty("rms_even_at_three_times_the_rays", std::to_string(rms(lavish.image, truth)));
}

TEST(SoftShadowsSlow, AtEqualCostNeverNoisierThanEvenSampling) {
  const std::vector<std::function<Stage()>> stages = {board, balls_and_columns, fence_and_two_lamps,
                                                      [] { return builtin("cornell-box"); },
                                                      [] { return builtin("cornell-spheres"); }};
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const Stage stage = stages[i]();
    const RayTracer tracer(stage.scene);
    for (const int samples : {1, 4}) {
      const RenderOptions options = picture(64, samples);
      RenderOptions reference = uniform(options, 1024);
      reference.exact_shadows = true;
      const Image truth = render(tracer, stage.camera, reference).image;
      const RenderResult sparing = render(tracer, stage.camera, selective(options, 16));
      const RenderResult even = uniform_at_the_cost_of(sparing.rays.total(), tracer, stage.camera, options);
      const double ratio = rms(sparing.image, truth) / rms(even.image, truth);
      RecordProperty("rms_ratio_" + std::to_string(i) + "_" + std::to_string(samples), std::to_string(ratio));
      EXPECT_LE(ratio, 1) << "scene " << i << ", samples a pixel " << samples;
    }
  }
}

// A wire hides a twentieth of the lamp: where its shadow falls, does the picture show any of it?
TEST(SoftShadows, AThinStripIsNotMissedMoreOften) {
  Stage stage = board();
  stage.scene.instances.erase(stage.scene.instances.begin());  // the board
  add_mesh(stage.scene, rectangle({-0.008, 1.3, -3}, {0, 0, 6}, {0.016, 0, 0}), matt(Rgb(0)), "wire");
  const RayTracer tracer(stage.scene);
  const RenderOptions options = picture(64, 1);
  RenderOptions exact = options;
  exact.exact_shadows = true;
  exact.shadow_samples = 2;
  const Image truth = render(tracer, stage.camera, exact).image;
  Scene open = stage.scene;
  open.instances.pop_back();
  const Image without = render(RayTracer(open), stage.camera, exact).image;
  const RenderResult sparing = render(tracer, stage.camera, selective(options, 16));
  const RenderResult even = uniform_at_the_cost_of(sparing.rays.total(), tracer, stage.camera, options);
  // The picture of even rays without the wire differs just where a ray met it.
  Scene bare = open;
  const RayTracer bare_tracer(bare);
  int in_shadow = 0, missed_by_sparing = 0, missed_by_even = 0;
  const int rays_each = static_cast<int>(std::lround(static_cast<double>(even.rays.shadow) / (64 * 64)));
  const Image even_without = render(bare_tracer, stage.camera, uniform(options, rays_each)).image;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double share = 1 - static_cast<double>(truth.pixel(x, y)[1]) / without.pixel(x, y)[1];
      if (!(share > 0.02 && share < 0.2)) continue;
      ++in_shadow;
      missed_by_even += even.image.pixel(x, y)[1] == even_without.pixel(x, y)[1] ? 1 : 0;
      // By how much a ray in 16 lowers it, at least.
      missed_by_sparing +=
          1 - static_cast<double>(sparing.image.pixel(x, y)[1]) / without.pixel(x, y)[1] < 0.01 ? 1 : 0;
    }
  }
  EXPECT_GT(in_shadow, 100);
  EXPECT_GT(missed_by_even, 0);
  EXPECT_LE(missed_by_sparing, missed_by_even);
}

TEST(SoftShadows, TheMeanIsKept) {
  const Stage stage = board();
  const RayTracer tracer(stage.scene);
  RenderOptions exact = picture(24, 1);
  exact.exact_shadows = true;
  const auto sum = [](const Image& image) {
    double all = 0;
    for (const float v : image.data) all += v;
    return all;
  };
  constexpr int seeds = 200;
  double mean = 0, squares = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    RenderOptions options = selective(picture(24, 1), 4);
    options.seed = exact.seed = static_cast<std::uint64_t>(seed);
    // Differences: the camera's rays are the same, the eye sees no lamp.
    const double difference =
        sum(render(tracer, stage.camera, options).image) - sum(render(tracer, stage.camera, exact).image);
    mean += difference / seeds;
    squares += difference * difference / seeds;
  }
  const double error = std::sqrt((squares - mean * mean) / seeds);
  EXPECT_LT(std::abs(mean), 3 * error);
  EXPECT_LT(error, 2e-3 * sum(render(tracer, stage.camera, exact).image));
}

TEST(SoftShadows, ExtraRaysGoToTheEdgesOfShadowsAlone) {
  const Stage stage = board();
  const RayTracer tracer(stage.scene);
  RenderOptions options = selective(picture(64, 1), 64);
  options.aovs = {Aov::rays};
  RenderOptions exact = picture(64, 1);
  exact.exact_shadows = true;
  const Image rays = render(tracer, stage.camera, options).image;
  const Image lit = render(tracer, stage.camera, exact).image;
  Scene open = stage.scene;
  open.instances.erase(open.instances.begin());
  const Image unhindered = render(RayTracer(open), stage.camera, exact).image;
  int partly = 0, found = 0, extra = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double share = static_cast<double>(lit.pixel(x, y)[1]) / unhindered.pixel(x, y)[1];
      const bool many = rays.pixel(x, y)[3] > 2;
      extra += many ? 1 : 0;
      if (!(share > 0.1 && share < 0.9)) continue;
      ++partly;
      found += many ? 1 : 0;
    }
  }
  EXPECT_GT(partly, 50);
  EXPECT_GE(found, 0.97 * partly);
  EXPECT_LT(extra, 0.35 * 64 * 64);
}

TEST(SoftShadowsThreaded, TheSameBitsOnAnyNumberOfThreadsAndInARegion) {
  const Stage stage = builtin("cornell-spheres");
  const RayTracer tracer(stage.scene);
  for (const bool exact : {false, true}) {
    for (const IntegratorKind kind : {IntegratorKind::appel, IntegratorKind::whitted}) {
      RenderOptions options = selective(picture(33, 2), 8);
      options.integrator = kind;
      options.exact_shadows = exact;
      const auto draw = [&](int threads) {
        const ThreadLimit limit(threads);
        return render(tracer, stage.camera, options);
      };
      const RenderResult one = draw(1);
      for (const int threads : {2, 8}) {
        const RenderResult many = draw(threads);
        EXPECT_EQ(many.image.data, one.image.data);
        EXPECT_EQ(many.rays.by_depth, one.rays.by_depth);
      }
      options.region = Region{7, 9, 25, 20};
      const Image part = draw(2).image;
      for (int y = 9; y < 20; ++y) {
        for (int x = 7; x < 25; ++x) ASSERT_EQ(part.rgb(x, y), one.image.rgb(x, y)) << x << ' ' << y;
      }
    }
  }
}

TEST(SoftShadowsThreaded, AdaptiveSamplingDrawsTheSameBitsOnAnyNumberOfThreads) {
  const Stage stage = builtin("cornell-spheres");
  const RayTracer tracer(stage.scene);
  RenderOptions options = selective(picture(24, 48), 4);
  options.noise = 0.2;
  const auto draw = [&](int threads) {
    const ThreadLimit limit(threads);
    return render(tracer, stage.camera, options);
  };
  const RenderResult one = draw(1);
  EXPECT_LT(one.mean_samples, 48);
  for (const int threads : {2, 8}) EXPECT_EQ(draw(threads).image.data, one.image.data);
}

}  // namespace
}  // namespace penumbra
