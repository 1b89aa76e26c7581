#include "penumbra/math/polygon_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "penumbra/math/polygon.h"

namespace penumbra {
namespace {

using Ring = std::vector<std::uint32_t>;

/// Twice the signed area of corners a, b, c about `normal`.
double turn(const Vec3d& normal, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(normal, cross(b - a, c - a));
}

/// An ear: its corner is not reflex and no other corner of the ring lies in its triangle.
bool is_ear(std::span<const Vec3d> polygon, const Ring& ring, std::size_t i, const Vec3d& normal) {
  const std::size_t n = ring.size();
  const std::uint32_t ia = ring[(i + n - 1) % n], ib = ring[i], ic = ring[(i + 1) % n];
  const Vec3d &a = polygon[ia], &b = polygon[ib], &c = polygon[ic];
  if (turn(normal, a, b, c) <= 0) return false;
  return std::none_of(ring.begin(), ring.end(), [&](std::uint32_t v) {
    const Vec3d& p = polygon[v];
    if (v == ia || v == ib || v == ic || p == a || p == b || p == c) return false;
    return turn(normal, a, b, p) >= 0 && turn(normal, b, c, p) >= 0 && turn(normal, c, a, p) >= 0;
  });
}

/// The corner to cut: among ears, the one whose triangle is fattest for its size; without one, the flattest corner.
std::size_t best_ear(std::span<const Vec3d> polygon, const Ring& ring, const Vec3d& normal) {
  const std::size_t n = ring.size();
  std::size_t best = n, flattest = 0;
  double best_shape = -1, least_turn = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d &a = polygon[ring[(i + n - 1) % n]], &b = polygon[ring[i]], &c = polygon[ring[(i + 1) % n]];
    const double area = turn(normal, a, b, c);
    if (std::abs(area) < least_turn) {
      least_turn = std::abs(area);
      flattest = i;
    }
    const double shape = area / (length_squared(b - a) + length_squared(c - b) + length_squared(a - c));
    if (shape > best_shape && is_ear(polygon, ring, i, normal)) {
      best_shape = shape;
      best = i;
    }
  }
  return best < n ? best : flattest;
}

bool ring_is_convex(std::span<const Vec3d> polygon, const Ring& ring) {
  std::vector<Vec3d> corners;
  for (const std::uint32_t v : ring) corners.push_back(polygon[v]);
  return is_convex(corners);
}

/// The ring that goes round `a` and `b` when they share an edge in opposite directions; empty when they do not.
Ring merged(const Ring& a, const Ring& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      if (a[i] != b[(k + 1) % b.size()] || a[(i + 1) % a.size()] != b[k]) continue;
      Ring ring;
      for (std::size_t step = 0; step < a.size(); ++step) ring.push_back(a[(i + 1 + step) % a.size()]);
      for (std::size_t step = 2; step < b.size(); ++step) ring.push_back(b[(k + step) % b.size()]);
      return ring;
    }
  }
  return {};
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(std::span<const Vec3d> polygon) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const Vec3d normal = polygon_normal(polygon);
  Ring ring(polygon.size());
  for (std::uint32_t i = 0; i < ring.size(); ++i) ring[i] = i;
  while (ring.size() > 3) {
    const std::size_t n = ring.size(), ear = best_ear(polygon, ring, normal);
    triangles.push_back({ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  if (ring.size() == 3) triangles.push_back({ring[0], ring[1], ring[2]});
  return triangles;
}

std::vector<std::vector<std::uint32_t>> convex_pieces(std::span<const Vec3d> polygon) {
  Ring whole(polygon.size());
  for (std::uint32_t i = 0; i < whole.size(); ++i) whole[i] = i;
  if (is_convex(polygon)) return {whole};
  std::vector<Ring> pieces;
  for (const auto& t : triangulate_polygon(polygon)) pieces.push_back({t[0], t[1], t[2]});
  // Merge greedily until no inner edge can go.
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t k = i + 1; k < pieces.size();) {
      const Ring ring = merged(pieces[i], pieces[k]);
      if (ring.empty() || !ring_is_convex(polygon, ring)) {
        ++k;
        continue;
      }
      pieces[i] = ring;
      pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(k));
      k = i + 1;
    }
  }
  return pieces;
}

std::vector<std::vector<Vec3d>> subtract_convex(std::span<const Vec3d> polygon, std::span<const Vec3d> hole) {
  std::vector<std::vector<Vec3d>> pieces;
  const Vec3d normal = polygon_normal(hole);
  const double tolerance = 1e-12 * std::max(polygon_size(polygon), polygon_size(hole));
  std::vector<Vec3d> rest(polygon.begin(), polygon.end()), outside, inside;
  for (std::size_t i = 0; i < hole.size() && !rest.empty(); ++i) {
    // The half-plane on the hole's side of this edge; what lies beyond is a piece, the rest goes on.
    const Vec3d& a = hole[i];
    const Vec3d along = hole[(i + 1) % hole.size()] - a;
    if (length(along) <= tolerance) continue;
    const Vec3d inwards = normalize(cross(normal, along));
    clip_polygon(rest, {-inwards, -dot(inwards, a)}, tolerance, outside);
    clip_polygon(rest, {inwards, dot(inwards, a)}, tolerance, inside);
    if (polygon_area(outside) > tolerance * tolerance) pieces.push_back(outside);
    rest.swap(inside);
  }
  // Hole and polygon do not overlap: give it back whole.
  if (rest.empty() || polygon_area(rest) <= tolerance * tolerance) {
    return {std::vector<Vec3d>(polygon.begin(), polygon.end())};
  }
  return pieces;
}

}  // namespace penumbra
