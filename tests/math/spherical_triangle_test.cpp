#include "penumbra/math/spherical_triangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "penumbra/math/sobol.h"

namespace penumbra {
namespace {

using std::numbers::pi;

/// The integral of the direction over a spherical triangle: half its edges' angles times their inward normals.
Vec3d vector_integral(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Vec3d sum(0);
  const Vec3d corners[] = {a, b, c};
  for (int k = 0; k < 3; ++k) {
    const Vec3d n = cross(corners[k], corners[(k + 1) % 3]);
    const double angle = std::atan2(length(n), dot(corners[k], corners[(k + 1) % 3]));
    sum += 0.5 * angle * normalize(n);
  }
  return dot(sum, a + b + c) > 0 ? sum : -sum;
}

TEST(SphericalTriangle, AnOctantIsAnEighthOfTheSphere) {
  EXPECT_NEAR(SphericalTriangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}).solid_angle(), pi / 2, 1e-14);
  EXPECT_NEAR(SphericalTriangle({0, 0, 1}, {0, 1, 0}, {1, 0, 0}).solid_angle(), pi / 2, 1e-14);
}

TEST(SphericalTriangle, FarAwayItIsAreaOverDistanceSquared) {
  const double d = 1e7;
  const auto seen = [&](double x, double y) { return normalize(Vec3d(x, y, d)); };
  const SphericalTriangle small(seen(0, 0), seen(1, 0), seen(0, 1));
  EXPECT_NEAR(small.solid_angle() * d * d, 0.5, 1e-6);
  const Vec3d inside = small.sample({0.3, 0.6});
  EXPECT_GE(inside.x, 0);
  EXPECT_GE(inside.y, 0);
  EXPECT_LE((inside.x + inside.y) * d, 1 + 1e-6);
}

// Even samples have the triangle's own mean direction and stay inside; so have those of one half of the numbers, which
// cut the triangle in two of equal size.
TEST(SphericalTriangle, SamplesAreEven) {
  const std::array<std::array<Vec3d, 3>, 4> triangles{{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                                       {{{1, 0, 0}, {-0.96, 0.28, 0}, {0, 0, 1}}},
                                                       {{{0.1, 0.2, 1}, {0.3, -0.2, 1}, {-0.2, 0.1, 1}}},
                                                       {{{0.001, 0, 1}, {0, 0.002, 1}, {-0.0005, 0.0001, 1}}}}};
  for (const auto& t : triangles) {
    const Vec3d a = normalize(t[0]), b = normalize(t[1]), c = normalize(t[2]);
    const SphericalTriangle triangle(a, b, c);
    constexpr std::uint32_t count = 1024;
    Vec3d sum(0);
    const double turn = dot(a, cross(b, c)) > 0 ? 1 : -1;
    for (std::uint32_t k = 0; k < count; ++k) {
      const Vec3d d = triangle.sample(owen_sobol_2d(k, 1));
      EXPECT_NEAR(length(d), 1, 1e-12);
      for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
        EXPECT_GT(turn * dot(d, cross(p, q)), -1e-12);
      }
      sum += d;
    }
    const Vec3d truth = vector_integral(a, b, c), found = triangle.solid_angle() / count * sum;
    EXPECT_LT(length(found - truth), 2e-3 * length(truth));
    // Half of the first number: the part on one side of the arc from b that halves it.
    const Vec3d middle = triangle.sample({0.5, 0});  // at b
    EXPECT_LT(length(middle - b), 1e-6);
    const Vec3d corner = triangle.sample({0.5, 1});
    EXPECT_NEAR(SphericalTriangle(a, b, corner).solid_angle() / triangle.solid_angle(), 0.5, 1e-6);
  }
}

}  // namespace
}  // namespace penumbra
