#include "penumbra/radiosity/form_factors/edge_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "radiosity/polygon_makers.h"
#include "test_paths.h"

namespace penumbra {
namespace {

TEST(EdgePair, AgreesWithThirtyDigitReferences) {
  std::ifstream file(PENUMBRA_TEST_DATA "/radiosity/edge_pairs.txt");
  std::string line;
  int count = 0;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name;
    Vec3d p[4];
    double want = 0;
    words >> name;
    for (Vec3d& v : p) words >> v.x >> v.y >> v.z;
    words >> want;
    ASSERT_TRUE(words) << line;
    const Edge a(p[0], p[1]), b(p[2], p[3]);
    const double limit = 4e-15 * a.length * b.length * (1 + std::abs(want) / (a.length * b.length));
    EXPECT_NEAR(log_distance_integral(a, b), want, limit) << line;
    EXPECT_NEAR(log_distance_integral(b, a), want, limit) << line;
    EXPECT_NEAR(log_distance_integral(Edge(p[1], p[0]), b), want, limit) << line;
    ++count;
  }
  EXPECT_GT(count, 50);
}

TEST(EdgePair, AddsUpOverPartsWhicheverRuleTakesThem) {
  Dice dice(21);
  for (int k = 0; k < 500; ++k) {
    const Vec3d a = dice.in_cube(), b = dice.in_cube(), c = k % 3 == 0 ? a : dice.in_cube();
    // From far to touching, at all angles: nearly parallel ones too.
    const double turn = std::pow(10, -dice.between(0, 10));
    const Vec3d d = k % 2 == 0 ? c + (b - a) * dice.between(0.1, 3) + turn * dice.in_cube() : dice.in_cube();
    const Vec3d cut = a + dice.between(0.01, 0.99) * (b - a);
    const Edge whole(a, b), other(c, d);
    const double sum = log_distance_integral(Edge(a, cut), other) + log_distance_integral(Edge(cut, b), other);
    EXPECT_NEAR(sum, log_distance_integral(whole, other), 2e-14 * (1 + whole.length * other.length)) << k;
  }
}

TEST(EdgePair, ScalesByTheLogarithm) {
  Dice dice(22);
  for (int k = 0; k < 100; ++k) {
    const Vec3d a = dice.in_cube(), b = dice.in_cube(), c = k % 2 == 0 ? a : dice.in_cube(), d = dice.in_cube();
    const double scale = std::pow(2, std::floor(dice.between(-20, 20)));
    const Edge e(a, b), f(c, d), e_scaled(scale * a, scale * b), f_scaled(scale * c, scale * d);
    const double lengths = e.length * f.length;
    EXPECT_NEAR(log_distance_integral(e_scaled, f_scaled) / (scale * scale),
                log_distance_integral(e, f) + lengths * std::log(scale), 1e-13 * lengths);
  }
}

TEST(EdgePair, EdgesWithoutLengthContributeNothing) {
  const Edge e(Vec3d(0), Vec3d(1, 0, 0)), point(Vec3d(0.5, 0, 0), Vec3d(0.5, 0, 0));
  EXPECT_EQ(log_distance_integral(e, point), 0);
  EXPECT_EQ(log_distance_integral(point, point), 0);
}

TEST(EdgePair, SingleIntegralIsFiniteOnTheEdge) {
  const Edge e(Vec3d(0), Vec3d(1, 0, 0));
  EXPECT_DOUBLE_EQ(log_distance_integral(Vec3d(0), e), -1);                          // integral of ln t over [0, 1]
  EXPECT_NEAR(log_distance_integral(Vec3d(0.5, 0, 0), e), -1 - std::log(2), 1e-15);  // two halves
  EXPECT_NEAR(log_distance_integral(Vec3d(0, 1, 0), e), 0.5 * std::log(2) - 1 + M_PI / 4, 1e-15);
}

}  // namespace
}  // namespace penumbra
