#include "penumbra/render/film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracing/soup.h"

namespace penumbra {
namespace {

std::size_t channel(const Image& image, const std::string& name) {
  const auto at = std::find(image.channels.begin(), image.channels.end(), name);
  EXPECT_NE(at, image.channels.end()) << name;
  return static_cast<std::size_t>(at - image.channels.begin());
}

TEST(Film, MeansAndVarianceAreThoseOfTheSamples) {
  testing::Dice dice(1);
  Film film(3, 2, {Aov::variance, Aov::direct, Aov::indirect, Aov::albedo, Aov::rays});
  constexpr int n = 37;
  double values[n];
  double direct = 0, rays = 0;
  for (double& v : values) {
    PixelEstimate e;
    v = dice.between(0, 5);
    e.radiance = Rgb(static_cast<float>(v), 2, 0);
    e.direct = Rgb(static_cast<float>(0.3 * v), 2, 0);
    e.albedo = Rgb(0.5F);
    e.rays = static_cast<float>(dice.below(9));
    direct += 0.3 * v / n;
    rays += e.rays / n;
    film.add(1, 1, e, 1);
  }
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) squares += (v - mean) * (v - mean);
  const Image image = film.develop();
  const float* p = image.pixel(1, 1);
  EXPECT_NEAR(p[0], mean, 1e-5);
  EXPECT_NEAR(p[1], 2, 1e-6);
  EXPECT_NEAR(p[channel(image, "variance.R")], squares / (n - 1) / n, 1e-6);  // of the mean, unbiased
  EXPECT_NEAR(p[channel(image, "variance.G")], 0, 1e-9);
  EXPECT_NEAR(p[channel(image, "direct.R")], direct, 1e-5);
  EXPECT_NEAR(p[channel(image, "indirect.R")], mean - direct, 1e-5);
  EXPECT_NEAR(p[channel(image, "albedo.B")], 0.5, 1e-6);
  EXPECT_NEAR(p[channel(image, "rays.count")], rays, 1e-5);
  EXPECT_NEAR(film.mean_samples(), n / 6.0, 1e-12);
  for (std::size_t c = 0; c < image.channels.size(); ++c) EXPECT_EQ(image.pixel(0, 0)[c], 0) << "never sampled";
}

TEST(Film, WeightsCountForColourAlone) {
  Film film(1, 1, {Aov::albedo});
  PixelEstimate e;
  e.radiance = Rgb(4);
  e.albedo = Rgb(0.25F);
  film.add(0, 0, e, 1.5F);
  film.add(0, 0, e, -0.5F);
  const Image image = film.develop();
  EXPECT_FLOAT_EQ(image.pixel(0, 0)[0], 2);  // (6 - 2) / 2
  EXPECT_FLOAT_EQ(image.pixel(0, 0)[channel(image, "albedo.R")], 0.25F);
}

TEST(Film, PlaceAndObjectAreThoseOfTheFirstSample) {
  Film film(1, 1, {Aov::object, Aov::depth, Aov::position, Aov::normal});
  PixelEstimate e;
  e.object = 3;
  e.depth = 5;
  e.position = {1, 2, 3};
  e.normal = {0, 1, 0};
  film.add(0, 0, e, 1);
  e.object = 4;
  e.depth = std::numeric_limits<float>::infinity();
  e.normal = {1, 0, 0};
  film.add(0, 0, e, 1);
  const Image image = film.develop();
  const float* p = image.pixel(0, 0);
  EXPECT_EQ(p[channel(image, "object.id")], 3);
  EXPECT_EQ(p[channel(image, "depth.Z")], 5);
  EXPECT_EQ(p[channel(image, "position.Y")], 2);
  EXPECT_NEAR(p[channel(image, "normal.X")], std::sqrt(0.5), 1e-6);  // mean, made unit
}

TEST(Film, LayersComeOnceAndInAFixedOrder) {
  const Image image = Film(1, 1, {Aov::rays, Aov::albedo, Aov::rays}).develop();
  EXPECT_EQ(image.channels,
            (std::vector<std::string>{"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "rays.count"}));
  EXPECT_EQ(Film(1, 1, {}).develop().channels.size(), 3U);
}

}  // namespace
}  // namespace penumbra
