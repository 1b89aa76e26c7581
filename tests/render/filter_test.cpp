#include "penumbra/render/filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

constexpr FilterKind kinds[] = {FilterKind::box, FilterKind::tent, FilterKind::gaussian, FilterKind::mitchell,
                                FilterKind::blackman_harris};

/// Mean of an axis's weight times offset^power, over a fine grid of random numbers. The weight of a sample is the
/// product of its axes', so the other axis is held where its weight is known from the two together.
double moment(const Filter& filter, int power, bool vertical) {
  constexpr int n = 400000;
  const double held = std::sqrt(static_cast<double>(filter.sample({0.5, 0.5}).weight));
  double sum = 0;
  for (int a = 0; a < n; ++a) {
    const double u = (a + 0.5) / n;
    const auto s = filter.sample(vertical ? Vec2d(0.5, u) : Vec2d(u, 0.5));
    sum += static_cast<double>(s.weight) * std::pow(vertical ? s.offset.y : s.offset.x, power);
  }
  return sum / n / held;
}

TEST(Filter, WeightsMeanOneAndTheMiddleStaysInPlace) {
  for (const FilterKind kind : kinds) {
    const Filter filter(kind);
    for (const bool vertical : {false, true}) {
      EXPECT_NEAR(moment(filter, 0, vertical), 1, 5e-5) << static_cast<int>(kind);
      EXPECT_NEAR(moment(filter, 1, vertical), 0, 5e-5) << static_cast<int>(kind);
      EXPECT_NEAR(moment(filter, 3, vertical), 0, 5e-5) << static_cast<int>(kind);
    }
  }
}

TEST(Filter, SpreadIsThatOfTheFilter) {
  for (const FilterKind kind : kinds) {
    const double r = Filter::radius(kind);
    double whole = 0, squares = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double x = r * (2 * (i + 0.5) / n - 1);
      whole += Filter::value(kind, x);
      squares += x * x * Filter::value(kind, x);
    }
    const Filter filter(kind);
    for (const bool vertical : {false, true}) {
      EXPECT_NEAR(moment(filter, 2, vertical), squares / whole, 1e-4) << static_cast<int>(kind);
    }
  }
}

TEST(Filter, ShapesAreTheTextbooks) {
  EXPECT_EQ(Filter::value(FilterKind::box, 0.4), 1);
  EXPECT_EQ(Filter::value(FilterKind::box, 0.6), 0);
  EXPECT_DOUBLE_EQ(Filter::value(FilterKind::tent, 0.25), 0.75);
  // Mitchell & Netravali 1988, B = C = 1/3: 8/9 in the middle, 1/18 at one pixel, negative beyond.
  EXPECT_NEAR(Filter::value(FilterKind::mitchell, 0), 8.0 / 9, 1e-12);
  EXPECT_NEAR(Filter::value(FilterKind::mitchell, 1), 1.0 / 18, 1e-12);
  EXPECT_LT(Filter::value(FilterKind::mitchell, 1.5), 0);
  EXPECT_NEAR(Filter::value(FilterKind::mitchell, 2), 0, 1e-12);
  // Its translates by whole pixels sum to one everywhere.
  for (const double x : {0.0, 0.1, 0.37, 0.5}) {
    double sum = 0;
    for (int i = -2; i <= 2; ++i) sum += Filter::value(FilterKind::mitchell, x + i);
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  EXPECT_NEAR(Filter::value(FilterKind::gaussian, 1.5), 0, 1e-12);
  EXPECT_NEAR(Filter::value(FilterKind::blackman_harris, 0), 1, 1e-12);
  EXPECT_NEAR(Filter::value(FilterKind::blackman_harris, 1.5), 6e-5, 1e-9);
  for (const FilterKind kind : kinds) {
    for (const double x : {0.1, 0.45, 0.9, 1.7}) {
      EXPECT_NEAR(Filter::value(kind, x), Filter::value(kind, -x), 1e-12);
    }
  }
}

TEST(Filter, SamplesStayWithinTheRadius) {
  for (const FilterKind kind : kinds) {
    const Filter filter(kind);
    for (const double u : {0.0, 1e-12, 0.25, 0.5, 0.75, 1 - 1e-12}) {
      const auto s = filter.sample({u, 1 - u - 1e-13});
      EXPECT_LE(std::abs(s.offset.x), Filter::radius(kind) + 1e-12);
      EXPECT_LE(std::abs(s.offset.y), Filter::radius(kind) + 1e-12);
      EXPECT_TRUE(std::isfinite(s.weight));
    }
  }
}

}  // namespace
}  // namespace penumbra
