#include "penumbra/baking/chart_growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "penumbra/math/transform.h"
#include "penumbra/math/vertex_welder.h"

namespace penumbra {
namespace {

/// A triangle's edge, as it runs.
struct HalfEdge {
  std::uint32_t low = 0, high = 0;  // welded vertices
  std::uint32_t place = 0;          // triangle * 3 + edge
  bool upwards = false;             // from low to high

  [[nodiscard]] bool same_edge(const HalfEdge& e) const { return low == e.low && high == e.high; }
};

std::vector<HalfEdge> sorted_edges(const Mesh& mesh) {
  std::vector<Vec3d> welded;
  VertexWelder welder(welded);
  std::vector<std::uint32_t> number;
  number.reserve(mesh.positions.size());
  for (const Vec3d& p : mesh.positions) number.push_back(welder.number(p));
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = number[mesh.triangles[t][k]], b = number[mesh.triangles[t][(k + 1) % 3]];
      if (a == b) continue;
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(3 * t + k), a < b});
    }
  }
  std::ranges::sort(edges, [](const HalfEdge& x, const HalfEdge& y) {
    return std::tie(x.low, x.high, x.place) < std::tie(y.low, y.high, y.place);
  });
  return edges;
}

double cosine(const Vec3d& a, const Vec3d& b) {
  const double size = length(a) * length(b);
  return size > 0 ? dot(a, b) / size : 1;
}

/// Whether a face that stands on the edge parts two others: light on one side of a wall is not that on the other.
bool wall_between(std::span<const HalfEdge> edge, const Vec3d& area, const PlacedTriangles& surface) {
  constexpr double parallel = 0.94;  // the cosine of 20 degrees
  return std::ranges::any_of(
      edge, [&](const HalfEdge& e) { return std::abs(cosine(area, surface.area_vectors[e.place / 3])) < parallel; });
}

/// Pairs the half-edges of one edge, likest planes first.
void pair_up(std::span<const HalfEdge> edge, const Mesh& mesh, PlacedTriangles& surface) {
  while (true) {
    double best = -2;
    const HalfEdge *up = nullptr, *down = nullptr;
    for (const HalfEdge& a : edge) {
      if (!a.upwards || surface.partner[a.place] != PlacedTriangles::no_partner) continue;
      for (const HalfEdge& b : edge) {
        if (b.upwards || surface.partner[b.place] != PlacedTriangles::no_partner) continue;
        const std::uint32_t s = a.place / 3, t = b.place / 3;
        if (s == t || mesh.material_of(s) != mesh.material_of(t)) continue;
        const double likeness = cosine(surface.area_vectors[s], surface.area_vectors[t]);
        if (likeness > best) best = likeness, up = &a, down = &b;
      }
    }
    if (up == nullptr || (edge.size() > 2 && wall_between(edge, surface.area_vectors[up->place / 3], surface))) return;
    surface.partner[up->place] = down->place / 3;
    surface.partner[down->place] = up->place / 3;
  }
}

}  // namespace

PlacedTriangles place_triangles(const Mesh& mesh, const Mat4d& to_world) {
  constexpr std::size_t crowd = 64;  // faces at one edge; more of them are some accident, and pairing is cubic
  PlacedTriangles surface;
  surface.positions.reserve(mesh.positions.size());
  for (const Vec3d& p : mesh.positions) surface.positions.push_back(transform_point(to_world, p));
  const double side = is_mirroring(to_world) ? -1 : 1;
  surface.area_vectors.reserve(mesh.triangles.size());
  for (const Mesh::Triangle& t : mesh.triangles) {
    const Vec3d &a = surface.positions[t[0]], &b = surface.positions[t[1]], &c = surface.positions[t[2]];
    const Vec3d area = side * cross(b - a, c - a);
    // Less than its corners' rounding is none.
    const double longest = std::max({length_squared(b - a), length_squared(c - b), length_squared(a - c)});
    surface.area_vectors.push_back(length(area) > 1e-12 * longest ? area : Vec3d(0));
  }
  surface.partner.assign(3 * mesh.triangles.size(), PlacedTriangles::no_partner);
  const std::vector<HalfEdge> edges = sorted_edges(mesh);
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last].same_edge(edges[first])) ++last;
    pair_up(std::span(edges).subspan(first, std::min(last - first, crowd)), mesh, surface);
  }
  return surface;
}

std::uint32_t grow_charts(const PlacedTriangles& surface, std::span<const std::uint32_t> triangles, double angle,
                          std::uint32_t first, std::vector<std::uint32_t>& chart_of) {
  // A little more than half: corners are rounded to single precision in files.
  const double least_cosine = std::cos(angle / 2) - 1e-9;
  std::vector<std::uint32_t> front;
  const auto grow_from = [&](std::uint32_t seed) {
    const Vec3d& normal = surface.area_vectors[seed];
    front.assign(1, seed);
    chart_of[seed] = first;
    for (std::size_t next = 0; next < front.size(); ++next) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t t = surface.partner[3 * std::size_t{front[next]} + k];
        if (t == PlacedTriangles::no_partner || chart_of[t] != ungrown) continue;
        if (cosine(normal, surface.area_vectors[t]) < least_cosine) continue;
        chart_of[t] = first;
        front.push_back(t);
      }
    }
    ++first;
  };
  // Triangles without an area have no plane to grow in, so they come last.
  for (const bool flat : {false, true}) {
    for (const std::uint32_t t : triangles) {
      if (chart_of[t] == ungrown && (surface.area_vectors[t] == Vec3d(0)) == flat) grow_from(t);
    }
  }
  return first;
}

std::vector<std::uint32_t> grow_charts(const PlacedTriangles& surface, double angle) {
  std::vector<std::uint32_t> chart_of(surface.area_vectors.size(), ungrown), all(chart_of.size());
  std::iota(all.begin(), all.end(), 0U);
  grow_charts(surface, all, angle, 0, chart_of);
  return chart_of;
}

}  // namespace penumbra
