#include "penumbra/tracing/shading/checker.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

SurfacePoint on_floor(double x, double z) {
  SurfacePoint p;
  p.position = {x, 0.3, z};
  p.geometric_normal = {0, 1, 0};
  return p;
}

/// The mean of the second colour over the parallelogram around a point, by many points.
double by_points(const SurfacePoint& middle, double size, const Footprint& footprint) {
  constexpr int n = 200;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      SurfacePoint p = middle;
      p.position += ((i + 0.5) / n - 0.5) * footprint.x + ((j + 0.5) / n - 0.5) * footprint.y;
      sum += static_cast<double>(second_colour_share(p, size));
    }
  }
  return sum / (n * n);
}

TEST(Checker, BoxesAlongTheSquaresAreExact) {
  for (const double width : {0.1, 0.7, 1.0, 1.9, 5.3}) {
    for (const double depth : {0.2, 0.7, 3.1}) {
      const Footprint footprint{{0, 0, width}, {depth, 0, 0}};
      for (const double x : {0.0, 0.26, -3.4}) {
        const SurfacePoint p = on_floor(x, 0.61 * x + 0.3);
        EXPECT_NEAR(static_cast<double>(second_colour_share(p, 0.8, footprint)), by_points(p, 0.8, footprint), 0.01)
            << width << " " << depth << " " << x;
      }
    }
  }
}

// Slanting footprints are approximated; along the squares' diagonals a thin one meets one colour only.
TEST(Checker, SlantingFootprintsAreNearlyRight) {
  double worst = 0;
  double sum = 0;
  int count = 0;
  for (const double size : {0.3, 1.0, 3.0, 8.0}) {
    for (const double angle : {0.3, 0.785398, 1.2, 2.0}) {
      for (const double thinness : {1.0, 0.4, 0.1}) {
        const Vec3d along(std::cos(angle), 0, std::sin(angle));
        const Footprint footprint{size * along, thinness * size * Vec3d(-along.z, 0, along.x)};
        for (const double x : {0.0, 0.31, 0.77}) {
          const SurfacePoint p = on_floor(x, 0.4 - x);
          const double error =
              std::abs(static_cast<double>(second_colour_share(p, 1, footprint)) - by_points(p, 1, footprint));
          worst = std::max(worst, error);
          sum += error;
          ++count;
        }
      }
    }
  }
  EXPECT_LT(worst, 0.15);
  EXPECT_LT(sum / count, 0.02);
  const Footprint diagonal{{8, 0, 8}, {0.05, 0, -0.05}};
  EXPECT_LT(second_colour_share(on_floor(0.5, 0.5), 1, diagonal), 0.1F);
}

TEST(Checker, EndlessFootprintsAreHalfAndHalf) {
  EXPECT_NEAR(second_colour_share(on_floor(0.2, 0.2), 1, {{1e7, 0, 3e6}, {0.1, 0, 0.2}}), 0.5F, 1e-2F);
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(second_colour_share(on_floor(0.2, 0.2), 1, {{inf, 0, 0}, {0, 0, std::nan("")}}), 0.5F);
}

TEST(Checker, NoFootprintIsThePoint) {
  for (const double x : {0.2, 1.2, -0.4, -2.7}) {
    EXPECT_EQ(second_colour_share(on_floor(x, 0.5), 1, {}), second_colour_share(on_floor(x, 0.5), 1));
  }
}

}  // namespace
}  // namespace penumbra
