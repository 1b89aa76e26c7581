#include "penumbra/math/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace penumbra {
namespace {

using Polygon = std::vector<Vec3d>;

const Polygon square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const Polygon el{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
const Polygon bow_tie{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}};

TEST(Polygon, MeasuresAreThoseOfTheTextbook) {
  EXPECT_DOUBLE_EQ(polygon_area(square), 1);
  EXPECT_EQ(polygon_normal(square), Vec3d(0, 0, 1));
  EXPECT_NEAR(length(polygon_centroid(square) - Vec3d(0.5, 0.5, 0)), 0, 1e-16);
  EXPECT_DOUBLE_EQ(polygon_area(el), 3);
  EXPECT_NEAR(length(polygon_centroid(el) - Vec3d(5.0 / 6, 5.0 / 6, 0)), 0, 1e-15);
  EXPECT_EQ(polygon_area(Polygon{{0, 0, 0}, {1, 1, 1}}), 0);
  EXPECT_EQ(polygon_normal(Polygon{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}), Vec3d(0));
}

TEST(Polygon, AreaKeepsItsDigitsFarFromTheOrigin) {
  Polygon far = square;
  for (Vec3d& p : far) p = 1.0 / 1024 * p + Vec3d(1e6, 1e6, -1e6);
  EXPECT_NEAR(polygon_area(far) * 1024 * 1024, 1, 1e-12);  // the corners are exact in binary
}

TEST(Polygon, PlanarityIsTheDistanceFromThePlane) {
  EXPECT_EQ(planarity_error(square), 0);
  Polygon bent = square;
  bent[2].z = 0.04;
  EXPECT_NEAR(planarity_error(bent), 0.01, 1e-4);  // alternately a quarter of it above and below
}

TEST(Polygon, KnowsConvexFromConcave) {
  EXPECT_TRUE(is_convex(square));
  EXPECT_FALSE(is_convex(el));
  EXPECT_FALSE(is_convex(bow_tie));
  EXPECT_TRUE(is_convex(Polygon{{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));  // a straight angle
  Polygon star;  // a pentagram turns left everywhere, but twice round
  for (int k = 0; k < 5; ++k) star.push_back({std::cos(0.8 * M_PI * k), std::sin(0.8 * M_PI * k), 0});
  EXPECT_FALSE(is_convex(star));
  EXPECT_FALSE(is_convex(Polygon{{0, 0, 0}, {1, 0, 0}}));
}

TEST(Polygon, FindsSelfIntersections) {
  EXPECT_FALSE(is_self_intersecting(square));
  EXPECT_FALSE(is_self_intersecting(el));
  EXPECT_TRUE(is_self_intersecting(bow_tie));
  EXPECT_TRUE(is_self_intersecting(Polygon{{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}}));  // runs back on itself
  EXPECT_TRUE(is_self_intersecting(Polygon{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0, 0}, {0, 2, 0}}));  // touches an edge
  EXPECT_FALSE(is_self_intersecting(Polygon{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}}));  // a straight angle
  Polygon tilted = el;
  for (Vec3d& p : tilted) p = {p.z + 5, p.x, p.y};
  EXPECT_FALSE(is_self_intersecting(tilted));
}

TEST(Polygon, ClippingKeepsWhatIsInFront) {
  Polygon out;
  clip_polygon(square, {{1, 0, 0}, 0.25}, 0, out);
  EXPECT_DOUBLE_EQ(polygon_area(out), 0.75);
  EXPECT_EQ(polygon_normal(out), Vec3d(0, 0, 1));
  clip_polygon(square, {{1, 0, 0}, -1}, 0, out);
  EXPECT_EQ(out, square);
  clip_polygon(square, {{1, 0, 0}, 2}, 0, out);
  EXPECT_TRUE(out.empty());
  clip_polygon(square, {{1, 0, 0}, 1}, 0, out);  // only an edge touches
  EXPECT_TRUE(out.empty());
  clip_polygon(square, {{-1, 0, 0}, -1 + 1e-12}, 1e-10, out);  // within the tolerance: bit by bit the same
  EXPECT_EQ(out, square);
}

TEST(Polygon, BothSidesOfACutMakeTheWhole) {
  for (int k = 0; k < 100; ++k) {
    const double angle = 0.7 * k;
    const Plane3 plane{{std::cos(angle), std::sin(angle), 0}, std::cos(angle) * 0.4 + std::sin(angle) * 0.7};
    Polygon front, back;
    clip_polygon(square, plane, 0, front);
    clip_polygon(square, {-plane.normal, -plane.offset}, 0, back);
    EXPECT_NEAR(polygon_area(front) + polygon_area(back), 1, 1e-15);
    for (const Vec3d& p : front) EXPECT_GE(plane.distance(p), -1e-15);
  }
}

TEST(Polygon, ProjectsOntoPlanes) {
  Polygon out;
  const Plane3 plane{normalize(Vec3d(1, 2, 3)), 0.3};
  project_polygon(square, plane, out);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(plane.distance(out[k]), 0, 1e-15);
    EXPECT_NEAR(length(cross(out[k] - square[k], plane.normal)), 0, 1e-15);
  }
  EXPECT_NEAR(polygon_area(out), plane.normal.z, 1e-15);  // the cosine between the planes
  std::vector<Vec2d> flat;
  project_polygon_2d(square, {1, 1, 0}, {0, 1, 0}, {-1, 0, 0}, flat);
  EXPECT_EQ(flat[0], Vec2d(-1, 1));
}

TEST(Polygon, ContainsItsCentreAndItsOutline) {
  EXPECT_TRUE(convex_contains(square, {0.5, 0.5, 3}));
  EXPECT_TRUE(convex_contains(square, {0, 0.5, 0}));
  EXPECT_FALSE(convex_contains(square, {1.001, 0.5, 0}));
}

}  // namespace
}  // namespace penumbra
