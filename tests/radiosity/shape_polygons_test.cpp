#include "penumbra/radiosity/shape_polygons.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "penumbra/math/polygon.h"

namespace penumbra {
namespace {

double area_of(const Shape& shape, int segments) {
  double sum = 0;
  for (const auto& p : shape_polygons(shape, segments)) sum += polygon_area(p);
  return sum;
}

TEST(ShapePolygons, AreasApproachTheRoundOnesFromBelowInSecondOrder) {
  const struct {
    Shape shape;
    double area;
  } cases[] = {{Sphere{{1, 2, 3}, 2}, 16 * M_PI},
               {Disk{{1, 2, 3}, normalize(Vec3d(1, 2, 2)), 3}, 9 * M_PI},
               {Cylinder{{1, 0, 0}, {1, 2, 1}, 0.5}, M_PI * std::sqrt(5.0)}};
  for (const auto& c : cases) {
    const double coarse = c.area - area_of(c.shape, 32), fine = c.area - area_of(c.shape, 64);
    EXPECT_GT(fine, 0);
    EXPECT_NEAR(coarse / fine, 4, 0.05);
  }
}

TEST(ShapePolygons, ArePlanarConvexAndFaceOutwards) {
  const Sphere sphere{{1, 2, 3}, 2};
  const auto balls = shape_polygons(sphere, 12);
  EXPECT_EQ(balls.size(), 12U * 6U);
  Vec3d closed(0);
  for (const auto& p : balls) {
    EXPECT_TRUE(is_convex(p));
    EXPECT_LT(planarity_error(p), 1e-14);
    EXPECT_GT(dot(polygon_normal(p), polygon_centroid(p) - sphere.centre), 0);
    for (const Vec3d& v : p) EXPECT_NEAR(length(v - sphere.centre), 2, 1e-14);
    closed += newell_vector(p);
  }
  EXPECT_NEAR(length(closed), 0, 1e-13);  // a closed surface has no vector area

  const Cylinder cylinder{{1, 0, 0}, {1, 2, 1}, 0.5};
  for (const auto& p : shape_polygons(cylinder, 8)) {
    EXPECT_LT(planarity_error(p), 1e-14);
    const Vec3d axis = normalize(cylinder.top - cylinder.base), out = polygon_centroid(p) - cylinder.base;
    EXPECT_GT(dot(polygon_normal(p), out - dot(out, axis) * axis), 0.4);
  }
  const Disk disk{{0, 0, 0}, {0, 0, -1}, 1};
  EXPECT_NEAR(length(polygon_normal(shape_polygons(disk, 5).at(0)) - disk.normal), 0, 1e-15);
}

TEST(ShapePolygons, RefusesWhatCannotBe) {
  EXPECT_THROW((void)shape_polygons(Sphere{}, 2), std::invalid_argument);
  EXPECT_THROW((void)shape_polygons(Plane{}, 16), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
