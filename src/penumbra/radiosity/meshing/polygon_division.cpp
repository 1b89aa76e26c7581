#include "penumbra/radiosity/meshing/polygon_division.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/math/frame.h"
#include "penumbra/math/polygon.h"

namespace penumbra {
namespace {

/// Opposite sides of a quadrilateral may differ by this factor before a grid on it is no longer of good shape.
constexpr double like_length = 3;
/// Longest edge squared over twice the area of a triangle beyond which it is long and thin (1.15 when equilateral).
constexpr double thin_triangle = 5;
/// A corner this close to the line of a cut, in parts of the polygon's length, is taken in place of the cut's end.
constexpr double corner_snap = 0.1;
/// Halvings of halvings; a polygon that does not fit after these has been asked for too much.
constexpr int deepest = 40;

using Corners = std::vector<Vec3d>;

bool precedes(const Vec3d& a, const Vec3d& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

/// The point k/n of the way from a to b, the same bits as (n-k)/n from b to a.
Vec3d edge_point(const Vec3d& a, const Vec3d& b, std::size_t k, std::size_t n) {
  if (k == 0) return a;
  if (k == n) return b;
  if (precedes(b, a)) return edge_point(b, a, n - k, n);
  return a + (static_cast<double>(k) / static_cast<double>(n)) * (b - a);
}

std::size_t parts(double length, double size) {
  // A length that is a multiple of the size up to rounding is not given one part more.
  return size > 0 && std::isfinite(size)
             ? static_cast<std::size_t>(std::max(1.0, std::ceil(length / size * (1 - 1e-9))))
             : 1;
}

enum class Rule { whole, grid, similar_triangles, halves };

struct Division {
  Rule rule = Rule::whole;
  std::size_t across = 1;  // along corners 0-1
  std::size_t along = 1;   // along corners 1-2
  [[nodiscard]] std::size_t cells() const { return across * along; }
};

Division choose_division(std::span<const Vec3d> p, double size) {
  if (!(size > 0) || !std::isfinite(size)) return {};
  const auto edge = [&](std::size_t i) { return length(p[(i + 1) % p.size()] - p[i]); };
  if (p.size() == 3) {
    const double longest = std::max({edge(0), edge(1), edge(2)});
    const std::size_t n = parts(longest, size);
    if (n == 1) return {};
    if (longest * longest > thin_triangle * 2 * polygon_area(p)) return {Rule::halves};
    return {Rule::similar_triangles, n, n};
  }
  if (p.size() == 4) {
    const auto alike = [&](double a, double b) { return std::max(a, b) <= like_length * std::min(a, b); };
    if (alike(edge(0), edge(2)) && alike(edge(1), edge(3))) {
      return {Rule::grid, parts(std::max(edge(0), edge(2)), size), parts(std::max(edge(1), edge(3)), size)};
    }
  }
  return {Rule::halves};
}

void emit_grid(std::span<const Vec3d> p, const Division& d, const PolygonCellSink& sink) {
  const auto point = [&](std::size_t i, std::size_t j) {
    if (j == 0) return edge_point(p[0], p[1], i, d.across);
    if (j == d.along) return edge_point(p[3], p[2], i, d.across);
    return edge_point(edge_point(p[0], p[3], j, d.along), edge_point(p[1], p[2], j, d.along), i, d.across);
  };
  for (std::size_t j = 0; j < d.along; ++j) {
    for (std::size_t i = 0; i < d.across; ++i) {
      sink(std::array{point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)});
    }
  }
}

void emit_similar_triangles(std::span<const Vec3d> p, std::size_t n, const PolygonCellSink& sink) {
  // Row j lies j/n of the way from edge 0-1 to corner 2; its points run from side 0-2 to side 1-2.
  const auto point = [&](std::size_t i, std::size_t j) {
    if (j == 0) return edge_point(p[0], p[1], i, n);
    if (i == 0) return edge_point(p[0], p[2], j, n);
    if (i + j == n) return edge_point(p[1], p[2], j, n);
    return edge_point(edge_point(p[0], p[2], j, n), edge_point(p[1], p[2], j, n), i, n - j);
  };
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i + j < n; ++i) {
      sink(std::array{point(i, j), point(i + 1, j), point(i, j + 1)});
      if (i + j + 1 < n) sink(std::array{point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)});
    }
  }
}

/// The direction in the polygon's plane along which its area spreads most.
Vec3d longest_axis(std::span<const Vec3d> p, const Vec3d& centre) {
  const Frame frame(polygon_normal(p));
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    // Second moments of the triangle (centre, a, b), up to the factor 1/12 that all share.
    const Vec3d a = p[i] - centre, b = p[(i + 1) % p.size()] - centre;
    const double ax = dot(a, frame.tangent), ay = dot(a, frame.bitangent);
    const double bx = dot(b, frame.tangent), by = dot(b, frame.bitangent);
    const double twice_area = ax * by - ay * bx;
    xx += twice_area * (ax * ax + ax * bx + bx * bx);
    yy += twice_area * (ay * ay + ay * by + by * by);
    xy += twice_area * (ax * ay + bx * by + 0.5 * (ax * by + bx * ay));
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  return std::cos(angle) * frame.tangent + std::sin(angle) * frame.bitangent;
}

double extent(std::span<const Vec3d> p, const Vec3d& axis) {
  double low = dot(p[0], axis), high = low;
  for (const Vec3d& v : p) {
    low = std::min(low, dot(v, axis));
    high = std::max(high, dot(v, axis));
  }
  return high - low;
}

bool fits(std::span<const Vec3d> p, double size) {
  double longest = extent(p, longest_axis(p, polygon_centroid(p)));
  for (std::size_t i = 0; i < p.size(); ++i) longest = std::max(longest, length(p[(i + 1) % p.size()] - p[i]));
  return parts(longest, size) == 1;
}

void emit_halves(std::span<const Vec3d> p, double size, const PolygonCellSink& sink, int depth) {
  if (depth == deepest || fits(p, size)) {
    sink(p);
    return;
  }
  Corners first, second;
  halve_polygon(p, first, second);
  if (second.empty()) {
    sink(p);
    return;
  }
  emit_halves(first, size, sink, depth + 1);
  emit_halves(second, size, sink, depth + 1);
}

/// The corners from the smallest one on, towards the smaller of its neighbours; true when that reverses them.
bool make_canonical(Corners& corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), precedes), corners.end());
  if (!precedes(corners.back(), corners[1])) return false;
  std::reverse(corners.begin() + 1, corners.end());
  return true;
}

void divide_canonical(std::span<const Vec3d> p, double size, const PolygonCellSink& sink) {
  const Division division = choose_division(p, size);
  switch (division.rule) {
    case Rule::whole:
      sink(p);
      break;
    case Rule::grid:
      emit_grid(p, division, sink);
      break;
    case Rule::similar_triangles:
      emit_similar_triangles(p, division.across, sink);
      break;
    case Rule::halves:
      emit_halves(p, size, sink, 0);
      break;
  }
}

}  // namespace

void halve_polygon(std::span<const Vec3d> polygon, std::vector<Vec3d>& first, std::vector<Vec3d>& second) {
  first.clear();
  second.clear();
  const Vec3d centre = polygon_centroid(polygon);
  const Vec3d axis = longest_axis(polygon, centre);
  const double snap = corner_snap * extent(polygon, axis);
  const std::size_t n = polygon.size();
  std::vector<double> side(n);
  for (std::size_t i = 0; i < n; ++i) side[i] = dot(polygon[i] - centre, axis);
  // Each of the two crossings may snap to one corner, the nearer end of its edge.
  std::vector<bool> on_cut(n, false);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    if ((side[i] < 0) == (side[next] < 0)) continue;
    const std::size_t nearer = std::abs(side[i]) <= std::abs(side[next]) ? i : next;
    if (std::abs(side[nearer]) <= snap) on_cut[nearer] = true;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    if (on_cut[i] || side[i] < 0) first.push_back(polygon[i]);
    if (on_cut[i] || side[i] >= 0) second.push_back(polygon[i]);
    if (on_cut[i] || on_cut[next] || (side[i] < 0) == (side[next] < 0)) continue;
    const double share = side[i] / (side[i] - side[next]);
    const Vec3d crossing = polygon[i] + share * (polygon[next] - polygon[i]);
    first.push_back(crossing);
    second.push_back(crossing);
  }
  if (first.size() < 3 || second.size() < 3) {
    first.assign(polygon.begin(), polygon.end());
    second.clear();
  }
}

void divide_polygon(std::span<const Vec3d> polygon, double size, const PolygonCellSink& sink) {
  Corners corners(polygon.begin(), polygon.end());
  if (!make_canonical(corners)) {
    divide_canonical(corners, size, sink);
    return;
  }
  Corners turned;
  divide_canonical(corners, size, [&](std::span<const Vec3d> cell) {
    turned.assign(cell.rbegin(), cell.rend());
    sink(turned);
  });
}

std::size_t count_cells(std::span<const Vec3d> polygon, double size) {
  Corners corners(polygon.begin(), polygon.end());
  make_canonical(corners);
  const Division division = choose_division(corners, size);
  if (division.rule != Rule::halves) return division.cells();
  std::size_t count = 0;
  emit_halves(
      corners, size, [&](std::span<const Vec3d>) { ++count; }, 0);
  return count;
}

}  // namespace penumbra
