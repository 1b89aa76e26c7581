// The parts of `auto`: occluder polygons, shafts, visible fragments and the open rules' error terms.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/math/polygon_pieces.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/cluster_lanes.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/form_factors/occluder_index.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/patch_clusters.h"
#include "penumbra/radiosity/form_factors/shaft.h"
#include "penumbra/radiosity/form_factors/silhouette.h"
#include "penumbra/radiosity/form_factors/visible_fragments.h"

namespace penumbra {
namespace {

using Polygon = std::vector<Vec3d>;

std::uint32_t append_vertex(PatchMesh& mesh, const Vec3d& p) {
  const auto found = std::find(mesh.vertices.begin(), mesh.vertices.end(), p);
  if (found != mesh.vertices.end()) return static_cast<std::uint32_t>(found - mesh.vertices.begin());
  mesh.vertices.push_back(p);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void append_patch(PatchMesh& mesh, const Polygon& polygon) {
  std::vector<std::uint32_t> corners;
  for (const Vec3d& p : polygon) corners.push_back(append_vertex(mesh, p));
  const auto surface = static_cast<std::uint32_t>(mesh.surfaces.size());
  mesh.surfaces.emplace_back();
  add_patch(mesh, corners, surface, surface);
}

void append_grid(PatchMesh& mesh, const Vec3d& corner, const Vec3d& u, int nu, const Vec3d& v, int nv) {
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      const Vec3d p = corner + static_cast<double>(i) * u + static_cast<double>(j) * v;
      append_patch(mesh, {p, p + u, p + u + v, p + v});
    }
}

// Something on both sides, so that nothing else is on the convex hull.
void append_far_away(PatchMesh& mesh) {
  for (double s : {-1.0, 1.0})
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d p(0), u(0), v(0);
      p[axis] = 64 * s;
      u[(axis + 1) % 3] = 1;
      v[(axis + 2) % 3] = 1;
      append_patch(mesh, {p, p + u, p + u + v, p + v});
    }
}

std::size_t near_occluders(const PatchMesh& mesh, double& area) {
  const OccluderPolygons o = make_occluder_polygons(mesh);
  std::size_t count = 0;
  area = 0;
  for (std::size_t k = 0; k < o.size(); ++k) {
    if (o.bounds[k].upper.x > 60 || o.bounds[k].lower.x < -60 || o.bounds[k].upper.y > 60 ||
        o.bounds[k].lower.y < -60 || o.bounds[k].upper.z > 60 || o.bounds[k].lower.z < -60)
      continue;
    ++count;
    area += polygon_area(o.polygon(k));
    EXPECT_TRUE(is_convex(o.polygon(k)));
  }
  return count;
}

TEST(OccluderPolygons, GridBecomesOneRectangle) {
  PatchMesh mesh;
  append_grid(mesh, {0, 0, 0}, {0.5, 0, 0}, 7, {0, 0.25, 0}, 5);
  append_far_away(mesh);
  double area = 0;
  EXPECT_EQ(near_occluders(mesh, area), 1U);
  EXPECT_NEAR(area, 3.5 * 1.25, 1e-6);
}

TEST(OccluderPolygons, PlateWithTwoSidesCountsOnce) {
  PatchMesh mesh;
  append_grid(mesh, {0, 0, 0}, {0.5, 0, 0}, 2, {0, 0.5, 0}, 2);
  append_grid(mesh, {0, 0, 0}, {0, 0.5, 0}, 2, {0.5, 0, 0}, 2);
  append_far_away(mesh);
  double area = 0;
  EXPECT_EQ(near_occluders(mesh, area), 1U);
}

TEST(OccluderPolygons, ConcaveAndPiercedRegionsKeepTheirArea) {
  PatchMesh corner;  // an L of 5 squares
  append_grid(corner, {0, 0, 0}, {1, 0, 0}, 3, {0, 1, 0}, 1);
  append_grid(corner, {0, 1, 0}, {1, 0, 0}, 1, {0, 1, 0}, 2);
  append_far_away(corner);
  double area = 0;
  EXPECT_LE(near_occluders(corner, area), 3U);
  EXPECT_NEAR(area, 5, 1e-6);

  PatchMesh frame;  // a window: 8 squares around a hole
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      if (i != 1 || j != 1) append_grid(frame, Vec3d(i, j, 0), {1, 0, 0}, 1, {0, 1, 0}, 1);
  append_far_away(frame);
  EXPECT_LE(near_occluders(frame, area), 6U);
  EXPECT_NEAR(area, 8, 1e-6);
}

TEST(OccluderPolygons, ConvexRoomHasNone) {
  PatchMesh mesh;
  append_grid(mesh, {0, 0, 0}, {0.5, 0, 0}, 2, {0, 0.5, 0}, 2);
  append_grid(mesh, {0, 0, 1}, {0, 0.5, 0}, 2, {0.5, 0, 0}, 2);
  append_grid(mesh, {0, 0, 0}, {0, 0.5, 0}, 2, {0, 0, 0.5}, 2);
  EXPECT_EQ(make_occluder_polygons(mesh).size(), 0U);
}

TEST(Shaft, HoldsEverySegmentBetweenItsBoxes) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto point = [&] { return Vec3d(uniform(random), uniform(random), uniform(random)); };
  int missed = 0;
  for (int run = 0; run < 2000; ++run) {
    Bounds a, b;
    const Vec3d away = 4.0 * (point() - Vec3d(0.5));
    for (int k = 0; k < 2; ++k) {
      a.grow(point());
      b.grow(point() + away);
    }
    const Shaft shaft(a, b);
    for (int k = 0; k < 5; ++k) {
      const Vec3d p = a.lower + point() * a.extent(), q = b.lower + point() * b.extent();
      Bounds tiny;
      tiny.grow(p + uniform(random) * (q - p));
      EXPECT_FALSE(shaft.misses(tiny));
    }
    Bounds aside;
    aside.grow(2.0 * (point() - Vec3d(0.5)) + 0.5 * away);
    missed += shaft.misses(aside) ? 1 : 0;
  }
  EXPECT_GT(missed, 500);  // it does exclude something
}

// Blockers parallel to the source: their shadows on its plane are scaled copies, which subtract_convex cuts out.
TEST(VisibleFragments, UnionOfOverlappingBlockersIsCutExactly) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  VisibleFragments fragments;
  for (int run = 0; run < 200; ++run) {
    const Polygon source{{0, 0, 2}, {0, 1, 2}, {1, 1, 2}, {1, 0, 2}};  // its front looks down
    fragments.set_source(source);
    Silhouette silhouette;
    silhouette.clear();
    std::vector<Polygon> blockers;
    const int count = 1 + run % 4;
    for (int k = 0; k < count; ++k) {
      const double h = 0.4 + 1.2 * uniform(random), x = uniform(random) - 0.2, y = uniform(random) - 0.2;
      const double w = 0.1 + 0.5 * uniform(random), turn = 3 * uniform(random);
      Polygon blocker;
      const int corners = 3 + k;
      for (int c = 0; c < corners; ++c) {
        const double angle = turn + 2 * 3.14159265358979 * c / corners;
        blocker.emplace_back(x + w * std::cos(angle), y + w * std::sin(angle), h);
      }
      silhouette.add_polygon(blocker, polygon_plane(blocker));
      blockers.push_back(blocker);
    }
    std::array<double, 8> x{}, y{}, z{}, found{}, open{};
    for (std::size_t k = 0; k < 8; ++k) {
      x[k] = 2 * uniform(random) - 0.5;
      y[k] = 2 * uniform(random) - 0.5;
      z[k] = 0.3 * uniform(random);
    }
    const Vec3d up{0, 0, 1};
    fragments.evaluate(silhouette, x.data(), y.data(), z.data(), 8, up, found.data(), open.data());
    for (std::size_t k = 0; k < 8; ++k) {
      const Vec3d point{x[k], y[k], z[k]};
      std::vector<Polygon> pieces{source};
      for (const Polygon& blocker : blockers) {
        Polygon shadow;
        for (const Vec3d& p : blocker) shadow.push_back(point + (2 - point.z) / (p.z - point.z) * (p - point));
        std::vector<Polygon> rest;
        for (const Polygon& piece : pieces)
          for (auto& part : subtract_convex(piece, shadow)) rest.push_back(part);
        pieces = rest;
      }
      double expected = 0;
      for (const Polygon& piece : pieces) expected += point_to_polygon(point, up, piece);
      EXPECT_NEAR(found[k], expected, 1e-7) << "run " << run << " blockers " << count;
      EXPECT_NEAR(open[k], point_to_polygon(point, up, source), 1e-12);
    }
  }
}

TEST(OccluderIndex, VerdictsAgreeWithRays) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] { return Vec3d(uniform(random), uniform(random), uniform(random)); };
  int hidden = 0, visible = 0;
  for (int run = 0; run < 3000; ++run) {
    PatchMesh mesh;
    const auto triangle = [&](const Vec3d& centre, double size) {
      return Polygon{centre + size * point(), centre + size * point(), centre + size * point()};
    };
    const Polygon a = triangle({0, 0, -2}, 0.4), b = triangle({0, 0, 2}, 0.4), o = triangle({0, 0, 0}, 2);
    append_patch(mesh, a);
    append_patch(mesh, b);
    append_patch(mesh, o);
    append_far_away(mesh);
    const OccluderPolygons occluders = make_occluder_polygons(mesh, false);
    const OccluderIndex index(occluders);
    for (std::size_t k = 0; k < occluders.size(); ++k) {
      if (occluders.bounds[k].diagonal() > 10 || length(occluders.bounds[k].centre()) > 10) continue;
      bool is_blocker = true;
      for (const Vec3d& p : occluders.polygon(k)) {
        double nearest = 1e9;
        for (const Vec3d& q : o) nearest = std::min(nearest, length(p - q));
        is_blocker = is_blocker && nearest < 1e-6;
      }
      if (!is_blocker) continue;
      const Sight sight = index.sight(a, b, k);
      hidden += sight == Sight::hidden ? 1 : 0;
      visible += sight == Sight::visible ? 1 : 0;
      if (sight == Sight::partial) continue;
      const Plane3 plane = polygon_plane(o);
      const auto inside = [&](const Polygon& t) {
        double u = 0.5 * (uniform(random) + 1), v = 0.5 * (uniform(random) + 1);
        if (u + v > 1) {
          u = 1 - u;
          v = 1 - v;
        }
        return t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
      };
      for (int ray = 0; ray < 10; ++ray) {
        const Vec3d p = inside(a), q = inside(b);
        const double dp = plane.distance(p), dq = plane.distance(q);
        const bool blocked = dp * dq < 0 && convex_contains(o, p + dp / (dp - dq) * (q - p));
        EXPECT_EQ(blocked, sight == Sight::hidden);
      }
    }
  }
  EXPECT_GT(hidden, 50);
  EXPECT_GT(visible, 500);
}

// The error terms of the point rules hold for nearly all random pairs, and their sum exceeds the sum of the errors.
TEST(ClusterLanes, ErrorTermsCoverTheErrors) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return normalize(Vec3d(normal(random), normal(random), normal(random))); };
  for (bool fine : {false, true}) {
    for (int corners : {3, 4}) {
      int count = 0, beyond = 0;
      double errors = 0, estimates = 0;
      while (count < 1000) {
        PatchMesh mesh;
        const auto add = [&](const Vec3d& centre, double size) {
          const Vec3d n = direction(), u = normalize(cross(n, direction())), v = cross(n, u);
          Polygon p;
          for (int c = 0; c < corners; ++c) {
            const double angle = 2 * 3.14159265358979 * (c + (corners == 3 ? 0.3 * uniform(random) : 0)) / corners;
            p.push_back(centre + size * (std::cos(angle) * u + std::sin(angle) * v));
          }
          append_patch(mesh, p);
        };
        const double size = std::pow(10.0, 2 * uniform(random) - 1), ratio = 0.05 + 0.7 * uniform(random);
        add(Vec3d(0), 1);
        add((1 + size) / ratio * direction(), size);
        const PatchClusters clusters = make_patch_clusters(mesh);
        LaneExchange e;
        far_exchange(clusters, 0, 0, 1e-9, e);
        if (fine) refine_exchange(clusters, 0, 0, 2, e);
        if ((e.facing & 2) == 0 || (e.straddling & 2) != 0) continue;
        ++count;
        const double error = std::abs(exchange_area(mesh.polygon(0), mesh.polygon(1)) - e.exchange[1]);
        beyond += error > e.error[1] ? 1 : 0;
        errors += error;
        estimates += e.error[1];
      }
      EXPECT_LE(beyond, count / 20) << fine << " " << corners;
      EXPECT_LE(errors, estimates);
    }
  }
}

}  // namespace
}  // namespace penumbra
