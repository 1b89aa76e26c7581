// What occluders that share corners hide, seen from points before, beside and inside them.

#include "penumbra/radiosity/form_factors/silhouette.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/visible_fragments.h"

namespace penumbra {
namespace {

using Polygon = std::vector<Vec3d>;

// Polygons that share corners where they meet, and something far away on all sides so that none is on the hull.
struct Solid {
  PatchMesh mesh;

  std::uint32_t vertex(const Vec3d& p) {
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
      if (length(mesh.vertices[v] - p) < 1e-12) return v;
    mesh.vertices.push_back(p);
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  }
  void add(const Polygon& polygon) {
    std::vector<std::uint32_t> ring;
    for (const Vec3d& p : polygon) ring.push_back(vertex(p));
    const auto surface = static_cast<std::uint32_t>(mesh.surfaces.size());
    mesh.surfaces.emplace_back();
    add_patch(mesh, ring, surface, surface);
  }
  OccluderPolygons occluders(bool merge) {
    for (double s : {-9.0, 9.0}) {
      for (int axis = 0; axis < 3; ++axis) {
        Vec3d p(0), u(0), v(0);
        p[axis] = s;
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
        add({p, p + u, p + u + v});
      }
    }
    mesh.radiating_count = mesh.patch_count();
    return make_occluder_polygons(mesh, merge);
  }
};

std::vector<std::uint32_t> near_ones(const OccluderPolygons& occluders) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t k = 0; k < occluders.size(); ++k)
    if (length(occluders.bounds[k].centre()) < 3) out.push_back(k);
  return out;
}

// A box without a bottom on the floor z = 0; `n` > 1 cuts its sides into strips.
Solid standing_box(int n) {
  Solid solid;
  const double x0 = 0.2, x1 = 0.5, y0 = 0.3, y1 = 0.8, h = 0.4;
  const std::array<Vec3d, 4> base{Vec3d(x0, y0, 0), Vec3d(x1, y0, 0), Vec3d(x1, y1, 0), Vec3d(x0, y1, 0)};
  for (std::size_t k = 0; k < 4; ++k) {
    for (int i = 0; i < n; ++i) {
      const Vec3d p = base[k] + (static_cast<double>(i) / n) * (base[(k + 1) % 4] - base[k]);
      const Vec3d q = base[k] + (static_cast<double>(i + 1) / n) * (base[(k + 1) % 4] - base[k]);
      const Vec3d up(0, 0, h);
      solid.add({p, q, q + up});
      solid.add({p, q + up, p + up});
    }
  }
  solid.add({{x0, y0, h}, {x1, y0, h}, {x1, y1, h}, {x0, y1, h}});
  return solid;
}

const Polygon floor_of_room{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<Polygon> walls{{{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}},
                                 {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}},
                                 {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}};

// The mean form factor from n x n midpoints of a parallelogram to another.
double mean_factor(const OccluderPolygons& occluders, const Polygon& from, const Polygon& to, int n) {
  const Plane3 plane = polygon_plane(from);
  Silhouette silhouette;
  silhouette.build(occluders, near_ones(occluders), from, plane, to, polygon_plane(to));
  VisibleFragments fragments;
  fragments.set_source(to);
  const auto count = static_cast<std::size_t>(n);
  std::vector<double> x(count), y(count), z(count), factors(count), open(count);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      const Vec3d p =
          from[0] + ((i + 0.5) / n) * (from[1] - from[0]) + ((static_cast<double>(j) + 0.5) / n) * (from[3] - from[0]);
      x[j] = p.x;
      y[j] = p.y;
      z[j] = p.z;
    }
    fragments.evaluate(silhouette, x.data(), y.data(), z.data(), count, plane.normal, factors.data(), open.data());
    for (double f : factors) sum += f;
  }
  return sum / (n * n);
}

TEST(Silhouette, BoxOnTheFloorHidesTheSameBothWays) {
  for (int strips : {1, 3}) {
    const OccluderPolygons occluders = standing_box(strips).occluders(strips == 1);
    for (const Polygon& wall : walls) {
      const double there = mean_factor(occluders, floor_of_room, wall, 240);
      EXPECT_NEAR(there, mean_factor(occluders, wall, floor_of_room, 240), 2e-6);
      EXPECT_LT(there, 0.19);  // without the box it would be 0.200043776
      EXPECT_GT(there, 0.1);
    }
  }
}

TEST(Silhouette, NothingIsSeenFromUnderTheBox) {
  const OccluderPolygons occluders = standing_box(3).occluders(false);
  const Polygon under{{0.2, 0.3, 0}, {0.5, 0.3, 0}, {0.5, 0.8, 0}, {0.2, 0.8, 0}};
  for (const Polygon& wall : walls) EXPECT_NEAR(mean_factor(occluders, under, wall, 64), 0, 1e-7);
}

TEST(Silhouette, EdgesInsideAWallAreForgotten) {
  const OccluderPolygons occluders = standing_box(4).occluders(false);
  const Polygon beside{{0.7, 0.4, 0}, {0.9, 0.4, 0}, {0.9, 0.6, 0}, {0.7, 0.6, 0}};
  Silhouette silhouette;
  silhouette.build(occluders, near_ones(occluders), beside, polygon_plane(beside), walls[1], polygon_plane(walls[1]));
  EXPECT_EQ(silhouette.polygon_count(), 33U);
  // A box from the front, and from behind in the same shape: its outline of six, and its rim on the floor.
  EXPECT_LE(silhouette.edges().size(), 9U);
}

// A bumpy closed surface of triangles around the origin.
Solid bumpy_ball(int rings, int sectors, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.6, 1.0);
  std::vector<std::vector<Vec3d>> grid;
  for (int r = 0; r <= rings; ++r) {
    grid.emplace_back();
    const double polar = std::numbers::pi * r / rings, pole = 0.5 * uniform(random);
    for (int s = 0; s < sectors; ++s) {
      const double turn = 2 * std::numbers::pi * s / sectors;
      const double radius = r == 0 || r == rings ? pole : 0.5 * uniform(random);
      grid.back().push_back(radius * Vec3d(r == 0 || r == rings ? 0 : std::sin(polar) * std::cos(turn),
                                           r == 0 || r == rings ? 0 : std::sin(polar) * std::sin(turn),
                                           std::cos(polar)));
    }
  }
  Solid solid;
  for (std::size_t r = 0; r + 1 < grid.size(); ++r) {
    for (std::size_t s = 0; s < grid[r].size(); ++s) {
      const std::size_t t = (s + 1) % grid[r].size();
      if (r > 0) solid.add({grid[r][s], grid[r + 1][s], grid[r][t]});
      if (r + 2 < grid.size()) solid.add({grid[r][t], grid[r + 1][s], grid[r + 1][t]});
    }
  }
  return solid;
}

TEST(Silhouette, BumpyBallHidesWhatItsTrianglesHide) {
  const Polygon source{{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}};  // its front looks down
  const Polygon receiver{{-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, {-1, 1, -2}};
  const Vec3d up(0, 0, 1);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (unsigned seed = 0; seed < 10; ++seed) {
    const OccluderPolygons occluders = bumpy_ball(6, 8, seed).occluders(false);
    const auto blockers = near_ones(occluders);
    Silhouette together, apart;
    together.build(occluders, blockers, receiver, polygon_plane(receiver), source, polygon_plane(source));
    apart.clear();
    for (std::uint32_t k : blockers) {  // each moved by itself: edges that coincide have no order
      Polygon alone(occluders.polygon(k).begin(), occluders.polygon(k).end());
      for (Vec3d& v : alone) v += 1e-8 * Vec3d(uniform(random), uniform(random), uniform(random));
      apart.add_polygon(alone, occluders.planes[k]);
    }
    EXPECT_LT(2 * together.edges().size(), apart.edges().size());
    VisibleFragments fragments;
    fragments.set_source(source);
    std::array<double, 8> x{}, y{}, z{}, found{}, expected{}, open{};
    for (std::size_t k = 0; k < 8; ++k) {
      x[k] = uniform(random);
      y[k] = uniform(random);
      z[k] = -2;
    }
    fragments.evaluate(together, x.data(), y.data(), z.data(), 8, up, found.data(), open.data());
    fragments.evaluate(apart, x.data(), y.data(), z.data(), 8, up, expected.data(), open.data());
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_NEAR(found[k], expected[k], 1e-7);
      EXPECT_NEAR(open[k], point_to_polygon({x[k], y[k], z[k]}, up, source), 1e-12);
      // And what rays say: a grid of them over the source.
      const Vec3d p(x[k], y[k], z[k]);
      constexpr int n = 80;
      double sum = 0;
      for (int i = 0; i < n * n; ++i) {
        const Vec3d q(-1 + (2 * (i % n) + 1.0) / n, -1 + (2.0 * (i / n) + 1.0) / n, 2);
        bool blocked = false;
        for (std::size_t b = 0; b < blockers.size() && !blocked; ++b) {
          const Plane3& plane = occluders.planes[blockers[b]];
          const double hp = plane.distance(p), hq = plane.distance(q);
          blocked = hp * hq < 0 && convex_contains(occluders.polygon(blockers[b]), p + hp / (hp - hq) * (q - p));
        }
        const Vec3d ray = q - p;
        if (!blocked) sum += ray.z * ray.z / (length_squared(ray) * length_squared(ray));
      }
      EXPECT_NEAR(found[k], sum * 4 / (n * n) / std::numbers::pi, 2e-3);
    }
  }
}

}  // namespace
}  // namespace penumbra
