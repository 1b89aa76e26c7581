#include "penumbra/radiosity/form_factors/analytic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "radiosity/polygon_makers.h"

namespace penumbra {
namespace {

constexpr double facing_unit_squares = 0.199824895698387;    // Howell C-11
constexpr double adjacent_unit_squares = 0.200043776075403;  // Howell C-14

double factor(const Polygon& from, const Polygon& to) { return polygon_to_polygon(from, to); }

TEST(Analytic, UnitCubeHasItsClosedForms) {
  const auto faces = room({1, 1, 1});
  for (std::size_t i = 0; i < 6; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < 6; ++j) {
      const double f = factor(faces[i], faces[j]);
      const double want = i == j ? 0 : i / 2 == j / 2 ? facing_unit_squares : adjacent_unit_squares;
      EXPECT_NEAR(f, want, 1e-14) << i << ' ' << j;
      sum += f;
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_EQ(factor(faces[i], faces[i]), 0);
  }
}

TEST(Analytic, RowsOfRandomConvexCavitiesSumToOne) {
  Dice dice(11);
  for (int k = 0; k < 25; ++k) {
    const auto faces = dice.convex_cavity(k % 9);
    for (const Polygon& from : faces) {
      double sum = 0;
      for (const Polygon& to : faces) sum += factor(from, to);
      EXPECT_NEAR(sum, 1, 1e-10) << "cavity " << k << ", area " << polygon_area(from);
    }
  }
}

TEST(Analytic, RowsOfSliverTetrahedraSumToOne) {
  Dice dice(12);
  for (int k = 0; k < 200; ++k) {
    const double flat = std::pow(10, -dice.between(0, 4));
    Vec3d q[4];
    for (Vec3d& p : q) p = dice.in_cube() * Vec3d(1, 1, flat);
    if (dot(cross(q[1] - q[0], q[2] - q[0]), q[3] - q[0]) < 0) std::swap(q[0], q[1]);
    const std::vector<Polygon> faces{{q[0], q[1], q[2]}, {q[0], q[3], q[1]}, {q[1], q[3], q[2]}, {q[0], q[2], q[3]}};
    for (const Polygon& from : faces) {
      double sum = 0;
      for (const Polygon& to : faces) sum += factor(from, to);
      EXPECT_NEAR(sum, 1, 1e-10) << "tetrahedron " << k << ", flat " << flat;
    }
  }
}

TEST(Analytic, IsReciprocal) {
  Dice dice(13);
  for (int k = 0; k < 300; ++k) {
    const Polygon a = dice.convex_polygon(), b = dice.convex_polygon();
    const double ab = exchange_area(a, b);
    EXPECT_NEAR(ab, exchange_area(b, a), 1e-13 * std::min(polygon_area(a), polygon_area(b)));
    EXPECT_GE(ab, 0);
    EXPECT_LE(ab, std::min(polygon_area(a), polygon_area(b)) * (1 + 1e-12));
  }
}

TEST(Analytic, IsTheAreaAverageOfLambertsSum) {
  Dice dice(14);
  for (int k = 0; k < 40; ++k) {
    // Apart and in front of each other, so that the point factor is smooth over the first.
    const Polygon a = transformed(dice.convex_polygon(), Mat4d(1)),
                  b = moved(dice.convex_polygon(), 4.0 * dice.direction());
    std::vector<WeightedPoint> points;
    polygon_rule(a, 24, points);
    bool mutual = true;
    for (const Vec3d& p : b) mutual = mutual && polygon_plane(a).distance(p) > 0;
    for (const Vec3d& p : a) mutual = mutual && polygon_plane(b).distance(p) > 0;
    if (!mutual) continue;
    double sum = 0;
    for (const WeightedPoint& p : points) sum += p.weight * point_to_polygon(p.point, polygon_normal(a), b);
    EXPECT_NEAR(exchange_area(a, b) / sum, 1, 1e-9);
  }
}

TEST(Analytic, AddsUpOverParts) {
  Dice dice(15);
  std::vector<Vec3d> left, right;
  for (int k = 0; k < 200; ++k) {
    const Polygon a = dice.convex_polygon(), b = dice.convex_polygon();
    const Vec3d n = dice.direction();
    const double offset = dot(n, polygon_centroid(b));
    clip_polygon(b, {n, offset}, 0, left);
    clip_polygon(b, {-n, -offset}, 0, right);
    const double area = std::min(polygon_area(a), polygon_area(b));
    EXPECT_NEAR(exchange_area(a, left) + exchange_area(a, right), exchange_area(a, b), 1e-12 * area);
  }
}

TEST(Analytic, TheRulesAgreeWhereOneTakesOverFromAnother) {
  // Parts are farther apart for their size than the whole, so they come by other rules.
  Dice dice(17);
  std::vector<Vec3d> left, right;
  for (int k = 0; k < 400; ++k) {
    const double distance = std::pow(10, dice.between(0.3, 3));
    const Polygon a = dice.convex_polygon(), b = moved(dice.convex_polygon(), distance * dice.direction());
    const Vec3d n = dice.direction();
    const double offset = dot(n, polygon_centroid(b));
    clip_polygon(b, {n, offset}, 0, left);
    clip_polygon(b, {-n, -offset}, 0, right);
    const double whole = exchange_area(a, b);
    EXPECT_NEAR(exchange_area(a, left) + exchange_area(a, right), whole, 1e-9 * whole + 1e-17) << distance;
  }
}

TEST(Analytic, DoesNotDependOnPlaceScaleOrNumbering) {
  Dice dice(16);
  for (int k = 0; k < 200; ++k) {
    Polygon a = dice.convex_polygon(), b = dice.convex_polygon();
    const double f = factor(a, b);
    const Mat4d motion = dice.motion();
    EXPECT_NEAR(factor(transformed(a, motion), transformed(b, motion)), f, 1e-12);
    const double scale = std::pow(10, dice.between(-6, 6));
    Polygon sa = a, sb = b;
    for (Vec3d& p : sa) p *= scale;
    for (Vec3d& p : sb) p *= scale;
    EXPECT_NEAR(factor(sa, sb), f, 1e-12);
    std::rotate(a.begin(), a.begin() + 1, a.end());
    std::rotate(b.begin(), b.begin() + 2, b.end());
    EXPECT_NEAR(factor(a, b), f, 1e-13);
  }
}

TEST(Analytic, SeesNothingFromBehindOrInItsOwnPlane) {
  const Polygon floor = floor_rectangle(0, 1, 0, 1);
  const Polygon ceiling = reversed(floor_rectangle(0, 1, 0, 1, 1));
  EXPECT_EQ(factor(floor, reversed(ceiling)), 0);
  EXPECT_EQ(factor(reversed(floor), ceiling), 0);
  EXPECT_EQ(factor(floor, floor), 0);
  EXPECT_EQ(factor(floor, reversed(floor)), 0);                    // the two sides of a plate
  EXPECT_EQ(factor(floor, floor_rectangle(1, 2, 0, 1)), 0);        // coplanar neighbours
  EXPECT_EQ(factor(floor, floor_rectangle(0.2, 0.5, 0, 0.3)), 0);  // coplanar, overlapping
  const Mat4d motion = Dice(3).motion();                           // and with rounding in the way
  EXPECT_EQ(factor(transformed(floor, motion), transformed(floor_rectangle(1, 2, 0, 1), motion)), 0);
}

// A wall from one corner to another height: F(floor to wall) by the closed form of perpendicular rectangles.
TEST(Analytic, TouchesAlongPartOfAnEdge) {
  // The wall stands on x = 0 and covers half of the floor's edge; with its other half it makes the whole wall.
  const Polygon floor = floor_rectangle(0, 1, 0, 1);
  const Polygon half{{0, 0, 0}, {0, 0.5, 0}, {0, 0.5, 1}, {0, 0, 1}};
  EXPECT_NEAR(factor(floor, half), 0.5 * adjacent_unit_squares, 1e-14);
  const Polygon third{{0, 0, 0}, {0, 1.0 / 3, 0}, {0, 1.0 / 3, 1}, {0, 0, 1}};
  const Polygon rest{{0, 1.0 / 3, 0}, {0, 1, 0}, {0, 1, 1}, {0, 1.0 / 3, 1}};
  EXPECT_NEAR(factor(floor, third) + factor(floor, rest), adjacent_unit_squares, 1e-14);
}

TEST(Analytic, TouchesAtOneCorner) {
  // Howell C-15 with the rectangles diagonal to each other across their common line.
  const Polygon floor = floor_rectangle(0, 1, 0, 1);
  const Polygon wall{{0, 1, 0}, {0, 2, 0}, {0, 2, 1}, {0, 1, 1}};
  EXPECT_NEAR(factor(floor, wall), 0.04059223010155854, 1e-14);
}

TEST(Analytic, ClipsWhatStandsAcrossTheOthersPlane) {
  const Polygon floor = floor_rectangle(0, 1, 0, 1);
  const Polygon wall{{0, 0, -2}, {0, 1, -2}, {0, 1, 1}, {0, 0, 1}};  // two thirds below the floor
  EXPECT_NEAR(factor(floor, wall), adjacent_unit_squares, 1e-14);
  const Polygon wide = floor_rectangle(-3, 1, 0, 1);  // three quarters behind the wall
  const Polygon upper{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};
  EXPECT_NEAR(factor(upper, wide), adjacent_unit_squares, 1e-14);
}

TEST(Analytic, NarrowGapsApproachContact) {
  const Polygon floor = floor_rectangle(0, 1, 0, 1);
  double last = 0;
  for (double gap = 1e-1; gap > 1e-12; gap /= 10) {
    const double f = factor(floor, reversed(floor_rectangle(0, 1, 0, 1, gap)));
    EXPECT_GT(f, last);
    EXPECT_NEAR(f, 1 - 2 * gap, gap * gap * (2 - std::log(gap)) + 1e-12) << gap;  // series of C-11
    last = f;
  }
}

TEST(Analytic, TinyPatchesKeepTheirDigits) {
  const auto faces = room({1, 1, 1});
  for (double size = 1e-1; size > 1e-11; size /= 10) {
    const Polygon at_wall = floor_rectangle(0, size, 0.3, 0.3 + size),
                  inside = floor_rectangle(0.3, 0.3 + size, 0.6, 0.6 + size);
    for (const Polygon& tiny : {at_wall, inside}) {
      double there = 0, back = 0;
      for (std::size_t j = 1; j < 6; ++j) {
        there += factor(tiny, faces[j]);
        back += exchange_area(faces[j], tiny) / polygon_area(tiny);
      }
      EXPECT_NEAR(there, 1, 1e-12) << size;
      EXPECT_NEAR(back, 1, 1e-12) << size;
    }
  }
}

TEST(Analytic, FarPairsKeepTheirRelativeDigits) {
  // The kernel d^2 / (d^2 + r^2)^2 in powers of 1/d, with the moments <r^2> = 1/3 and <r^4> = 17/90 of the offset
  // between points of two unit squares.
  const Polygon floor = floor_rectangle(-0.5, 0.5, -0.5, 0.5);
  for (double distance = 10; distance < 1e8; distance *= 10) {
    const double f = factor(floor, reversed(floor_rectangle(-0.5, 0.5, -0.5, 0.5, distance)));
    const double x2 = 1 / (distance * distance);
    EXPECT_NEAR(f * M_PI / x2, 1 - 2 * x2 / 3 + 17 * x2 * x2 / 30, x2 * x2 * x2 + 1e-13) << distance;
  }
}

TEST(Analytic, FarFromTheOriginLosesOnlyWhatTheCoordinatesLose) {
  const Vec3d away(1e6, -2e6, 3e6);
  const auto faces = room({1, 1, 1});
  EXPECT_NEAR(factor(moved(faces[0], away), moved(faces[1], away)), facing_unit_squares, 1e-9);
  EXPECT_NEAR(factor(moved(faces[0], away), moved(faces[2], away)), adjacent_unit_squares, 1e-9);
}

TEST(Analytic, ConcavePolygonsEqualTheirParts) {
  const Polygon el{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  const Polygon part1 = floor_rectangle(0, 2, 0, 1), part2 = floor_rectangle(0, 1, 1, 2);
  const Polygon ceiling = reversed(floor_rectangle(-1, 3, 0, 2, 0.7));
  EXPECT_NEAR(exchange_area(el, ceiling), exchange_area(part1, ceiling) + exchange_area(part2, ceiling), 1e-13);
  const Polygon slanted{{3, 0, -1}, {3, 2, -1}, {3, 2, 1}, {3, 0, 1}};
  EXPECT_NEAR(exchange_area(el, reversed(slanted)),
              exchange_area(part1, reversed(slanted)) + exchange_area(part2, reversed(slanted)), 1e-13);
}

TEST(Analytic, PolygonsWithoutAreaExchangeNothing) {
  const Polygon floor = floor_rectangle(0, 1, 0, 1);
  EXPECT_EQ(exchange_area(floor, Polygon{{0, 0, 1}, {1, 0, 1}}), 0);
  EXPECT_EQ(exchange_area(floor, Polygon{}), 0);
  EXPECT_NEAR(exchange_area(floor, Polygon{{0, 0, 1}, {1, 1, 1}, {0.5, 0.5, 1}}), 0, 1e-15);
  EXPECT_EQ(polygon_to_polygon(Polygon{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, floor), 0);
}

}  // namespace
}  // namespace penumbra
