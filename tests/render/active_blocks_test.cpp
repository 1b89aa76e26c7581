// Adaptive sampling: effort goes where the noise is, the target is met, and deciding by the samples themselves leaves
// no bias that could be seen.

#include "penumbra/render/active_blocks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

PixelEstimate bright(float value) {
  PixelEstimate e;
  e.radiance = Rgb(value);
  return e;
}

// Pixels of brightness 1 with standard deviation 0.5 where `noisy`, else without noise.
template <class Noisy>
Film film_of(int width, int height, int samples, const Noisy& noisy) {
  Film film(width, height, {}, true);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < samples; ++s) film.add(x, y, bright(noisy(x, y) ? (s % 2 == 0 ? 0.5F : 1.5F) : 1.0F), 1);
    }
  }
  return film;
}

TEST(ActiveBlocks, RestWhereItIsQuietAndNoNeighbourIsNoisy) {
  // One noisy pixel in block (2, 1) of 6 x 3 blocks, the last of them cut.
  const Film film = film_of(22, 10, 26, [](int x, int y) { return x == 9 && y == 6; });
  // Its own error is 0.5 / 5; the block's is a quarter of that.
  EXPECT_NEAR(std::sqrt(film.squared_error(9, 6)), 0.1, 1e-6);
  ActiveBlocks awake({0, 0, 22, 10}, 0.0249);
  EXPECT_EQ(awake.block_count(), 18U);
  EXPECT_EQ(awake.active_count(), 18U);
  awake.update(film);
  EXPECT_EQ(awake.active_count(), 9U);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_EQ(awake.is_active(column, row), column >= 1 && column <= 3) << column << " " << row;
    }
  }
  ActiveBlocks asleep({0, 0, 22, 10}, 0.0251);
  asleep.update(film);
  EXPECT_EQ(asleep.active_count(), 0U);
}

TEST(ActiveBlocks, BlackPixelsAreNotNoisyAndDarkOnesMeasureByThePicture) {
  Film film(8, 4, {}, true);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      // Left black but for a sparkle of a thousandth; right 1.
      for (int s = 0; s < 100; ++s) film.add(x, y, bright(x >= 4 ? 1.0F : s % 2 == 0 ? 0.002F : 0.0F), 1);
    }
  }
  // Standard error 0.0001 against a hundredth of 0.5: 0.02.
  ActiveBlocks loose({0, 0, 8, 4}, 0.021), tight({0, 0, 8, 4}, 0.019);
  loose.update(film);
  tight.update(film);
  EXPECT_EQ(loose.active_count(), 0U);
  EXPECT_EQ(tight.active_count(), 2U);
}

struct Drawn {
  Image image;
  double samples;
};

Drawn draw(const RayTracer& tracer, double noise, int samples, std::uint64_t seed) {
  RenderOptions options = testing::path(samples);
  options.width = options.height = 32;
  options.noise = noise;
  options.seed = seed;
  const RenderResult result = render(tracer, tracer.scene().cameras.at(0), options);
  return {result.image, result.mean_samples};
}

double mean_of(const Image& image) {
  double sum = 0;
  for (const float v : image.data) sum += v;
  return sum / static_cast<double>(image.data.size());
}

// The mean over many seeds against uniform sampling with as many: equal within three standard errors of their
// difference, itself below half a percent.
TEST(AdaptiveSamplingSlow, HasNoBiasThatCouldBeSeen) {
  const Scene scene = make_builtin_scene("cornell-box");
  const RayTracer tracer(scene);
  constexpr int seeds = 24;
  double sums[2] = {}, squares[2] = {}, samples = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const Drawn adaptive = draw(tracer, 0.2, 256, static_cast<std::uint64_t>(seed));
    samples += adaptive.samples / seeds;
    const double means[] = {mean_of(adaptive.image),
                            mean_of(draw(tracer, 0, 64, 1000 + static_cast<std::uint64_t>(seed)).image)};
    for (int k = 0; k < 2; ++k) {
      sums[k] += means[k];
      squares[k] += means[k] * means[k];
    }
  }
  EXPECT_GT(samples, 16);
  EXPECT_LT(samples, 200);
  double error2 = 0;
  for (int k = 0; k < 2; ++k) error2 += (squares[k] / seeds - sums[k] * sums[k] / seeds / seeds) / (seeds - 1);
  const double uniform = sums[1] / seeds;
  EXPECT_LT(std::sqrt(error2), 0.005 * uniform);
  EXPECT_NEAR(sums[0] / seeds, uniform, 3 * std::sqrt(error2));
}

}  // namespace
}  // namespace penumbra
