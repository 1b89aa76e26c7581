// Contrast-driven sampling: a pixel is that of few samples or that of all, edges are found, and no bias could be seen.

#include "penumbra/render/contrast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

TEST(ContrastedPixels, AreBothSidesOfAStepAndNothingElse) {
  Image picture(9, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 9; ++x) picture.set_rgb(x, y, x < 4 ? Rgb(1) : Rgb(1, 1, 1.5F));  // contrast 0.2, blue only
  }
  const Region all{0, 0, 9, 5};
  const auto found = contrasted_pixels(picture, all, 0.199);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 9; ++x) {
      EXPECT_EQ(found[static_cast<std::size_t>(9 * y + x)], x == 3 || x == 4 ? 1 : 0) << x << " " << y;
    }
  }
  for (const std::uint8_t mark : contrasted_pixels(picture, all, 0.201)) EXPECT_EQ(mark, 0);
  // A region beside the step knows what lies outside of it.
  const auto beside = contrasted_pixels(picture, {4, 1, 6, 3}, 0.199);
  EXPECT_EQ(beside, (std::vector<std::uint8_t>{1, 0, 1, 0}));
}

TEST(ContrastedPixels, WhatIsNearlyBlackRests) {
  Image picture(8, 8);
  for (int x = 0; x < 8; ++x) picture.set_rgb(x, 0, Rgb(8));  // a mean of 1
  picture.set_rgb(3, 6, Rgb(0.0019F));                        // a tenth of two hundredths is 0.002
  picture.set_rgb(6, 6, Rgb(0.0021F));
  const auto found = contrasted_pixels(picture, {0, 0, 8, 8}, 0.1);
  EXPECT_EQ(found[6 * 8 + 3], 0);
  EXPECT_EQ(found[6 * 8 + 6], 1);
}

RenderOptions still_life(int samples, double contrast) {
  RenderOptions options;
  options.width = 75;
  options.height = 50;
  options.samples_per_pixel = samples;
  options.contrast = contrast;
  return options;
}

double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    const double d = static_cast<double>(a.data[i]) - static_cast<double>(b.data[i]);
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(a.data.size()));
}

/// Up to rounding: sums of a tree's rays are in the order in which packets came to hold them.
bool are_near(const Rgb& a, const Rgb& b) { return max_component(glm::abs(a - b)) <= 1e-5F * max_component(b) + 1e-7F; }

double mean_of(const Image& image) {
  double sum = 0;
  for (const float v : image.data) sum += static_cast<double>(v);
  return sum / static_cast<double>(image.data.size());
}

TEST(Contrast, EachPixelIsThatOfOneSampleOrThatOfAll) {
  const Scene scene = make_builtin_scene("whitted");
  const RayTracer tracer(scene);
  const Camera& camera = scene.cameras.at(0);
  const Image few = render(tracer, camera, still_life(1, 0)).image;
  const Image all = render(tracer, camera, still_life(9, 0)).image;
  const RenderResult mixed = render(tracer, camera, still_life(9, 0.1));
  const auto marks = contrasted_pixels(few, {0, 0, 75, 50}, 0.1);
  double samples = 0;
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 75; ++x) {
      const bool marked = marks[static_cast<std::size_t>(75 * y + x)] != 0;
      EXPECT_PRED2(are_near, mixed.image.rgb(x, y), (marked ? all : few).rgb(x, y)) << x << " " << y;
      samples += marked ? 10 : 1;
    }
  }
  EXPECT_NEAR(mixed.mean_samples, samples / (75 * 50), 1e-9);
}

// A part of a picture has the pixels of the whole: its border is judged by what lies beyond.
TEST(Contrast, APartIsAsInTheWhole) {
  Scene scene = make_builtin_scene("whitted");
  const RayTracer tracer(scene);
  RenderOptions options = still_life(4, 0.3);
  const Image whole = render(tracer, scene.cameras[0], options).image;
  options.region = Region{20, 15, 55, 45};
  const Image part = render(tracer, scene.cameras[0], options).image;
  int other = 0;  // where the floor under dark colours, which is the region's, decides
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 75; ++x) {
      const bool inside = x >= 20 && x < 55 && y >= 15 && y < 45;
      if (!are_near(part.rgb(x, y), inside ? whole.rgb(x, y) : Rgb(0))) ++other;
    }
  }
  EXPECT_LT(other, 5);
}

// Kirk & Arvo 1991: samples that decide and are kept leave a bias; these are not kept.
TEST(Contrast, IsNearlyAsGoodAsAllSamplesEverywhereAndHasNoBiasToBeSeen) {
  const Scene scene = make_builtin_scene("whitted");
  const RayTracer tracer(scene);
  const Camera& camera = scene.cameras.at(0);
  const auto draw = [&](int samples, double contrast) {
    RenderOptions options = still_life(samples, contrast);
    options.width = 160;
    options.height = 120;
    return render(tracer, camera, options);
  };
  const Image reference = draw(100, 0).image;
  const double few = rms(draw(1, 0).image, reference);
  const double all = rms(draw(9, 0).image, reference);
  const RenderResult mixed = draw(9, 0.05);
  EXPECT_LT(rms(mixed.image, reference), 1.15 * all);
  EXPECT_LT(rms(mixed.image, reference), 0.5 * few);
  EXPECT_LT(mixed.mean_samples, 0.7 * 9);
  EXPECT_NEAR(mean_of(mixed.image) / mean_of(reference), 1, 2e-3);
}

// Soft shadows: some samples before the judgement, so that it is not noise alone.
TEST(Contrast, PenumbrasKeepTheirMean) {
  const Scene scene = make_builtin_scene("cornell-box");
  const RayTracer tracer(scene);
  RenderOptions options = still_life(16, 0.1);
  options.integrator = IntegratorKind::appel;
  options.width = options.height = 64;
  const RenderResult mixed = render(tracer, scene.cameras[0], options);
  options.contrast = 0;
  options.samples_per_pixel = 100;
  const Image reference = render(tracer, scene.cameras[0], options).image;
  EXPECT_GT(mixed.mean_samples, 4);
  EXPECT_LT(mixed.mean_samples, 16);
  EXPECT_NEAR(mean_of(mixed.image) / mean_of(reference), 1, 5e-3);
}

TEST(Contrast, ThreadedPicturesAreTheSameBits) {
  const Scene scene = make_builtin_scene("whitted");
  const RayTracer tracer(scene);
  const ThreadLimit one(1);
  const Image expected = render(tracer, scene.cameras[0], still_life(9, 0.1)).image;
  for (const int threads : {2, 8}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(render(tracer, scene.cameras[0], still_life(9, 0.1)).image.data, expected.data);
  }
}

TEST(Contrast, IsRefusedWhereItTellsNothing) {
  const Scene scene = make_builtin_scene("cornell-box");
  const RayTracer tracer(scene);
  RenderOptions options = still_life(9, 0.1);
  options.integrator = IntegratorKind::path;
  EXPECT_THROW((void)render(tracer, scene.cameras[0], options), std::invalid_argument);
  options = still_life(64, 0.1);
  options.noise = 0.1;
  EXPECT_THROW((void)render(tracer, scene.cameras[0], options), std::invalid_argument);
  EXPECT_THROW((void)render(tracer, scene.cameras[0], still_life(9, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
