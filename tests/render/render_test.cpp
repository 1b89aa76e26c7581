#include "penumbra/render/render.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <stop_token>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

constexpr IntegratorKind integrators[] = {IntegratorKind::appel, IntegratorKind::whitted, IntegratorKind::path};

/// A scene of everything: meshes, exact shapes, glass, mirrors, lamps.
struct Stage {
  Scene scene = make_builtin_scene("cornell-spheres");
  RayTracer tracer{scene};
  RenderOptions options;

  Stage() {
    options.width = 45;
    options.height = 37;
    options.samples_per_pixel = 3;
  }
  [[nodiscard]] RenderResult draw(const Progress& progress = {}) const {
    return render(tracer, scene.cameras.at(0), options, progress);
  }
};

TEST(RenderThreaded, AnyNumberOfThreadsDrawsTheSameBits) {
  Stage stage;
  for (const IntegratorKind kind : integrators) {
    stage.options.integrator = kind;
    for (const bool layers : {false, true}) {
      stage.options.aovs = layers ? std::vector{Aov::variance, Aov::normal, Aov::rays} : std::vector<Aov>{};
      const auto draw = [&](int threads) {
        const ThreadLimit limit(threads);
        return stage.draw();
      };
      const RenderResult one = draw(1);
      for (const int threads : {2, 8}) {
        const RenderResult many = draw(threads);
        EXPECT_EQ(many.image.data, one.image.data) << static_cast<int>(kind) << " on " << threads;
        EXPECT_EQ(many.rays.total(), one.rays.total());
        EXPECT_EQ(many.rays.by_depth, one.rays.by_depth);
      }
    }
  }
}

TEST(RenderThreaded, AdaptiveSamplingDrawsTheSameBitsOnAnyNumberOfThreads) {
  Stage stage;
  stage.options.samples_per_pixel = 48;
  stage.options.noise = 0.3;
  for (const IntegratorKind kind : integrators) {
    stage.options.integrator = kind;
    const auto draw = [&](int threads) {
      const ThreadLimit limit(threads);
      return stage.draw();
    };
    const RenderResult one = draw(1);
    EXPECT_LT(one.mean_samples, 48);
    for (const int threads : {2, 8}) EXPECT_EQ(draw(threads).image.data, one.image.data) << static_cast<int>(kind);
  }
}

TEST(Render, TheSameSeedGivesTheSamePictureAnotherAnother) {
  Stage stage;
  stage.options.integrator = IntegratorKind::path;
  const Image first = stage.draw().image;
  EXPECT_EQ(stage.draw().image.data, first.data);
  stage.options.seed = 1;
  EXPECT_NE(stage.draw().image.data, first.data);
}

TEST(Render, ARegionIsAPartOfTheWholePicture) {
  Stage stage;
  for (const IntegratorKind kind : integrators) {
    stage.options.integrator = kind;
    stage.options.region.reset();
    const Image whole = stage.draw().image;
    // Off the grid of tiles and packets: the same random numbers, but packets hold other rays.
    stage.options.region = Region{5, 7, 30, 21};
    const RenderResult part = stage.draw();
    EXPECT_EQ(part.rays.primary, 25U * 14 * 3);
    EXPECT_EQ(part.mean_samples, 3);
    for (int y = 0; y < 37; ++y) {
      for (int x = 0; x < 45; ++x) {
        const bool inside = x >= 5 && x < 30 && y >= 7 && y < 21;
        const Rgb truth = inside ? whole.rgb(x, y) : Rgb(0);
        ASSERT_LT(length(part.image.rgb(x, y) - truth), 1e-5F + 1e-5F * length(truth)) << x << " " << y;
      }
    }
  }
}

TEST(Render, AStopLeavesWhatWasDone) {
  Stage stage;
  stage.options.samples_per_pixel = 64;
  std::stop_source stop;
  Progress progress;
  progress.stop = stop.get_token();
  double last = 0;
  progress.report = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
    if (fraction > 0.2) stop.request_stop();
  };
  const RenderResult result = stage.draw(progress);
  EXPECT_TRUE(result.partial);
  EXPECT_GE(result.mean_samples, 1);
  EXPECT_LT(result.mean_samples, 64);
  double sum = 0;
  for (const float v : result.image.data) sum += v;
  EXPECT_GT(sum, 0);
  // Stopped before it began: black, and said to be partial.
  const RenderResult nothing = stage.draw(progress);
  EXPECT_TRUE(nothing.partial);
  EXPECT_EQ(nothing.mean_samples, 0);
  EXPECT_EQ(nothing.rays.total(), 0U);
}

TEST(Render, ATimeLimitIsKept) {
  Stage stage;
  stage.options.integrator = IntegratorKind::path;
  stage.options.samples_per_pixel = 1 << 20;
  stage.options.time_limit = 0.2;
  const RenderResult result = stage.draw();
  EXPECT_TRUE(result.partial);
  EXPECT_GE(result.mean_samples, 1);
  EXPECT_LT(result.seconds, 5);
  stage.options.samples_per_pixel = 1;
  stage.options.time_limit = 600;
  EXPECT_FALSE(stage.draw().partial);
}

TEST(Render, ProgressEndsAtOne) {
  Stage stage;
  double last = 0;
  Progress progress;
  progress.report = [&](std::string_view stage_name, double fraction) {
    EXPECT_EQ(stage_name, "render");
    last = fraction;
  };
  EXPECT_FALSE(stage.draw(progress).partial);
  EXPECT_EQ(last, 1);
}

TEST(Render, RefusesOptionsOutOfRange) {
  const Stage good;
  const auto refuses = [&](auto&& spoil) {
    Stage stage;
    spoil(stage.options);
    EXPECT_THROW((void)stage.draw(), std::invalid_argument);
  };
  refuses([](RenderOptions& o) { o.width = 0; });
  refuses([](RenderOptions& o) { o.height = max_render_side + 1; });
  refuses([](RenderOptions& o) { o.samples_per_pixel = 0; });
  refuses([](RenderOptions& o) { o.max_depth = -1; });
  refuses([](RenderOptions& o) { o.min_throughput = 2; });
  refuses([](RenderOptions& o) { o.min_throughput = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](RenderOptions& o) { o.time_limit = -1; });
  refuses([](RenderOptions& o) { o.region = Region{3, 3, 3, 5}; });
  refuses([](RenderOptions& o) { o.region = Region{0, 0, 46, 5}; });
  EXPECT_NO_THROW((void)good.draw());
}

// A picture keeps its mean whatever filter draws it, for an even world.
TEST(Render, FiltersKeepEvenPicturesEven) {
  Scene scene;
  scene.environment = Environment{};
  const RayTracer tracer(scene);
  for (const FilterKind kind :
       {FilterKind::box, FilterKind::tent, FilterKind::gaussian, FilterKind::mitchell, FilterKind::blackman_harris}) {
    RenderOptions options;
    options.width = options.height = 8;
    options.samples_per_pixel = 256;
    options.filter = kind;
    const Image image = render(tracer, Camera{}, options).image;
    double mean = 0;
    for (const float v : image.data) mean += v / static_cast<double>(image.data.size());
    EXPECT_NEAR(mean, 1, 0.005) << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace penumbra
