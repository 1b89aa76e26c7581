#include "penumbra/math/polygon_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "penumbra/math/polygon.h"

namespace penumbra {
namespace {

using Polygon = std::vector<Vec3d>;

Polygon corners_of(const Polygon& polygon, const auto& ring) {
  Polygon out;
  for (const std::uint32_t v : ring) out.push_back(polygon[v]);
  return out;
}

/// A comb with `teeth` teeth: as concave as can be.
Polygon comb(int teeth) {
  Polygon p{{0, -1, 0}, {2.0 * teeth, -1, 0}};
  for (int k = teeth; k-- > 0;) {
    p.push_back({2.0 * k + 2, 0, 0});
    p.push_back({2.0 * k + 1, 3, 0});
  }
  p.push_back({0, 0, 0});
  return p;
}

Polygon spiral() {
  return {{0, 0, 0}, {5, 0, 0}, {5, 5, 0}, {1, 5, 0}, {1, 2, 0}, {3, 2, 0},
          {3, 3, 0}, {2, 3, 0}, {2, 4, 0}, {4, 4, 0}, {4, 1, 0}, {0, 1, 0}};
}

TEST(PolygonPieces, TrianglesCoverThePolygonOnce) {
  for (const Polygon& p : {comb(1), comb(5), spiral()}) {
    double sum = 0;
    const auto triangles = triangulate_polygon(p);
    EXPECT_EQ(triangles.size(), p.size() - 2);
    for (const auto& t : triangles) {
      const Polygon corners = corners_of(p, t);
      EXPECT_GT(dot(newell_vector(corners), newell_vector(p)), 0);
      sum += polygon_area(corners);
    }
    EXPECT_NEAR(sum, polygon_area(p), 1e-12);
  }
}

TEST(PolygonPieces, TrianglesOfAPolygonWithStraightAnglesCoverIt) {
  const Polygon p{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}};
  double sum = 0;
  for (const auto& t : triangulate_polygon(p)) sum += polygon_area(corners_of(p, t));
  EXPECT_NEAR(sum, 4, 1e-14);
}

TEST(PolygonPieces, ConvexPiecesAreConvexAndCoverThePolygon) {
  const Polygon el{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  for (const Polygon& p : {comb(1), comb(6), spiral(), el}) {
    double sum = 0;
    const auto pieces = convex_pieces(p);
    for (const auto& ring : pieces) {
      const Polygon corners = corners_of(p, ring);
      EXPECT_TRUE(is_convex(corners));
      EXPECT_GT(dot(newell_vector(corners), newell_vector(p)), 0);
      sum += polygon_area(corners);
    }
    EXPECT_NEAR(sum, polygon_area(p), 1e-12);
    EXPECT_LT(pieces.size(), p.size() - 2);
  }
  EXPECT_EQ(convex_pieces(el).size(), 2U);
  EXPECT_EQ(convex_pieces(Polygon{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}).size(), 1U);
}

TEST(PolygonPieces, AWindowIsCutOutOfAWall) {
  const Polygon wall{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}};
  const Polygon window{{1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}};
  for (const Polygon& hole : {window, Polygon(window.rbegin(), window.rend())}) {
    double sum = 0;
    for (const Polygon& piece : subtract_convex(wall, hole)) {
      EXPECT_TRUE(is_convex(piece));
      EXPECT_GT(polygon_normal(piece).z, 0.99);
      EXPECT_FALSE(convex_contains(piece, {1.5, 1.5, 0}));
      sum += polygon_area(piece);
    }
    EXPECT_NEAR(sum, 11, 1e-14);
  }
}

TEST(PolygonPieces, AHoleMayStickOutMissOrCoverAll) {
  const Polygon wall{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}};
  const auto area_without = [&](const Polygon& hole) {
    double sum = 0;
    for (const Polygon& piece : subtract_convex(wall, hole)) sum += polygon_area(piece);
    return sum;
  };
  EXPECT_NEAR(area_without({{3, 2, 0}, {5, 2, 0}, {5, 5, 0}, {3, 5, 0}}), 11, 1e-14);
  EXPECT_NEAR(area_without({{5, 2, 0}, {6, 2, 0}, {6, 5, 0}, {5, 5, 0}}), 12, 1e-14);
  EXPECT_NEAR(area_without({{4, 0, 0}, {6, 0, 0}, {6, 3, 0}, {4, 3, 0}}), 12, 1e-14);  // beside it
  EXPECT_EQ(area_without({{-1, -1, 0}, {9, -1, 0}, {9, 9, 0}, {-1, 9, 0}}), 0);
  EXPECT_EQ(area_without(wall), 0);
}

}  // namespace
}  // namespace penumbra
