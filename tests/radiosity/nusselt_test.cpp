#include "penumbra/radiosity/form_factors/nusselt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "penumbra/radiosity/form_factors/point.h"
#include "radiosity/polygon_makers.h"

namespace penumbra {
namespace {

const Vec3d up(0, 0, 1);

TEST(Nusselt, HalfTheSkyIsSeenInAHalfPlaneWall) {
  // A wall without end beside the element covers half of its hemisphere.
  const double far = 1e9;
  const Polygon wall{{1, -far, -far}, {1, -far, far}, {1, far, far}, {1, far, -far}};
  EXPECT_NEAR(point_to_polygon({0, 0, 0}, up, wall), 0.5, 1e-8);
  const Polygon ceiling = reversed(floor_rectangle(-far, far, -far, far, 1));
  EXPECT_NEAR(point_to_polygon({0, 0, 0}, up, ceiling), 1, 1e-8);
}

TEST(Nusselt, AroundAnyPointOfAConvexCavityFactorsSumToOne) {
  Dice dice(31);
  for (int k = 0; k < 40; ++k) {
    const auto faces = dice.convex_cavity(k % 9);
    // Within the cavity, any orientation: every face is clipped somewhere.
    const Vec3d inside = dice.in_cube(0.2), normal = dice.direction();
    double sum = 0;
    for (const Polygon& face : faces) sum += point_to_polygon(inside, normal, face);
    EXPECT_NEAR(sum, 1, 1e-12);
    // On a face, its own factor is zero and the others still fill the hemisphere.
    const Vec3d on_face = polygon_centroid(faces[0]);
    sum = 0;
    for (std::size_t j = 1; j < faces.size(); ++j) sum += point_to_polygon(on_face, polygon_normal(faces[0]), faces[j]);
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

TEST(Nusselt, AddsUpOverParts) {
  Dice dice(32);
  std::vector<Vec3d> left, right;
  for (int k = 0; k < 500; ++k) {
    const Polygon p = dice.convex_polygon();
    const Vec3d eye = dice.in_cube(), normal = dice.direction(), n = dice.direction();
    const double offset = dot(n, polygon_centroid(p));
    clip_polygon(p, {n, offset}, 0, left);
    clip_polygon(p, {-n, -offset}, 0, right);
    EXPECT_NEAR(point_to_polygon(eye, normal, left) + point_to_polygon(eye, normal, right),
                point_to_polygon(eye, normal, p), 1e-13);
  }
}

TEST(Nusselt, DoesNotDependOnPlaceScaleOrNumbering) {
  Dice dice(33);
  for (int k = 0; k < 500; ++k) {
    Polygon p = dice.convex_polygon();
    const Vec3d eye = dice.in_cube(), normal = dice.direction();
    const double f = point_to_polygon(eye, normal, p);
    const Mat4d motion = dice.motion();
    EXPECT_NEAR(
        point_to_polygon(transform_point(motion, eye), transform_vector(motion, normal), transformed(p, motion)), f,
        1e-13);
    std::rotate(p.begin(), p.begin() + 1, p.end());
    EXPECT_NEAR(point_to_polygon(eye, normal, p), f, 1e-15);
    for (Vec3d& v : p) v = eye + 1e5 * (v - eye);
    EXPECT_NEAR(point_to_polygon(eye, normal, p), f, 1e-9);
  }
}

TEST(Nusselt, ZeroBelowTheHorizonFromBehindAndInThePlane) {
  const Polygon ceiling = reversed(floor_rectangle(0, 1, 0, 1, 1));
  EXPECT_GT(point_to_polygon({0.5, 0.5, 0}, up, ceiling), 0);
  EXPECT_EQ(point_to_polygon({0.5, 0.5, 0}, -up, ceiling), 0);
  EXPECT_EQ(point_to_polygon({0.5, 0.5, 2}, -up, ceiling), 0);
  EXPECT_EQ(point_to_polygon({0.5, 0.5, 1}, -up, ceiling), 0);
  EXPECT_EQ(point_to_polygon({0, 0, 1}, up, ceiling), 0);
  EXPECT_EQ(point_to_polygon({0, 0, 0}, up, Polygon{}), 0);
}

TEST(Nusselt, TouchingTheHorizonChangesNothing) {
  // Howell B-4: rectangle in the plane x = c, standing on the element's horizon, y in [0, b], z in [0, a].
  const double a = 1, b = 1, c = 1, want = 0.0557341970025535;
  const Polygon wall{{c, 0, 0}, {c, 0, a}, {c, b, a}, {c, b, 0}};
  EXPECT_NEAR(point_to_polygon({0, 0, 0}, up, wall), want, 1e-15);
  for (const double below : {1e-300, 1e-17, 1e-12, 1e-3, 1.0, 1e6}) {  // what hangs below is not seen
    const Polygon deeper{{c, 0, -below}, {c, 0, a}, {c, b, a}, {c, b, -below}};
    EXPECT_NEAR(point_to_polygon({0, 0, 0}, up, deeper), want, 1e-15) << below;
  }
  const Polygon one_corner{{c, 0, 0}, {c, 0, a}, {c, b, a}};  // a triangle standing on a corner, and its complement
  const Polygon one_edge{{c, 0, 0}, {c, b, a}, {c, b, 0}};
  EXPECT_NEAR(point_to_polygon({0, 0, 0}, up, one_corner) + point_to_polygon({0, 0, 0}, up, one_edge), want, 1e-15);
}

TEST(Nusselt, FarAwayItIsTheKernelTimesTheArea) {
  const Polygon p = reversed(floor_rectangle(-0.5, 0.5, -0.5, 0.5, 1e4));
  const double kernel = point_kernel({3e3, 0, 0}, up, {0, 0, 1e4}, -up);
  EXPECT_NEAR(point_to_polygon({3e3, 0, 0}, up, p) / kernel, 1, 1e-6);
}

TEST(Point, KernelIsZeroBehindEitherElement) {
  EXPECT_DOUBLE_EQ(point_kernel({0, 0, 0}, up, {0, 0, 2}, -up), 1 / (4 * M_PI));
  EXPECT_EQ(point_kernel({0, 0, 0}, up, {0, 0, 2}, up), 0);
  EXPECT_EQ(point_kernel({0, 0, 0}, -up, {0, 0, 2}, -up), 0);
  EXPECT_EQ(point_kernel({0, 0, 0}, up, {0, 0, 0}, -up), 0);
}

}  // namespace
}  // namespace penumbra
