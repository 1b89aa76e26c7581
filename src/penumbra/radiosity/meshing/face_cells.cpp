#include "penumbra/radiosity/meshing/face_cells.h"

#include <algorithm>
#include <cmath>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/meshing/polygon_division.h"

namespace penumbra {
namespace {

/// How far a polygon reaches to either side of a line in its plane.
struct Reach {
  double left = 0, right = 0;
};

Reach reach(std::span<const Vec3d> cell, const Plane3& line) {
  Reach r;
  for (const Vec3d& p : cell) {
    const double d = line.distance(p);
    r.left = std::max(r.left, d);
    r.right = std::max(r.right, -d);
  }
  return r;
}

/// The part of the segment's length that lies within a convex cell.
double overlap(std::span<const Vec3d> cell, const Vec3d& a, const Vec3d& b, const Vec3d& normal) {
  double enter = 0, exit = 1;
  const Vec3d along = b - a;
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const Vec3d inward = cross(normal, cell[(k + 1) % cell.size()] - cell[k]);
    const double at_a = dot(inward, a - cell[k]), slope = dot(inward, along);
    if (slope == 0) {
      if (at_a < 0) return 0;
      continue;
    }
    const double t = -at_a / slope;
    (slope > 0 ? enter : exit) = slope > 0 ? std::max(enter, t) : std::min(exit, t);
  }
  return std::max(0.0, exit - enter) * length(along);
}

/// Splits a ring by a line; crossings are the same bits in both parts.
void split(std::span<const Vec3d> cell, const Plane3& line, double tolerance, std::vector<Vec3d>& left,
           std::vector<Vec3d>& right) {
  left.clear();
  right.clear();
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const Vec3d &p = cell[k], &q = cell[(k + 1) % cell.size()];
    const double dp = line.distance(p), dq = line.distance(q);
    const bool p_on = std::abs(dp) <= tolerance, q_on = std::abs(dq) <= tolerance;
    if (p_on || dp > 0) left.push_back(p);
    if (p_on || dp < 0) right.push_back(p);
    if (p_on || q_on || (dp > 0) == (dq > 0)) continue;
    const Vec3d crossing = p + (dp / (dp - dq)) * (q - p);
    left.push_back(crossing);
    right.push_back(crossing);
  }
}

}  // namespace

std::size_t FaceCells::cut_along(const Vec3d& a, const Vec3d& b, const Vec3d& normal, double snap) {
  const Vec3d across = cross(normal, b - a);
  if (!(length(across) > 0)) return 0;
  const Vec3d n = normalize(across);
  const Plane3 line{n, dot(n, a)};
  std::size_t cut = 0;
  Cell left, right;
  const std::size_t count = cells_.size();
  for (std::size_t c = 0; c < count; ++c) {
    const Reach r = reach(cells_[c], line);
    if (std::min(r.left, r.right) <= snap || overlap(cells_[c], a, b, normal) <= snap) continue;
    split(cells_[c], line, 0.1 * snap, left, right);
    if (left.size() < 3 || right.size() < 3) continue;
    cells_[c] = left;
    cells_.push_back(right);
    ++cut;
  }
  return cut;
}

void halve_cell(std::span<const Vec3d> cell, std::size_t edge, std::vector<Vec3d>& first, std::vector<Vec3d>& second) {
  const std::size_t n = cell.size();
  const auto corner = [&](std::size_t k) { return cell[(edge + k) % n]; };
  const auto middle = [&](std::size_t k) { return 0.5 * (corner(k) + corner(k + 1)); };
  if (n == 3) {
    first = {corner(0), middle(0), corner(2)};
    second = {middle(0), corner(1), corner(2)};
  } else if (n == 4) {
    first = {corner(0), middle(0), middle(2), corner(3)};
    second = {middle(0), corner(1), corner(2), middle(2)};
  } else {
    halve_polygon(cell, first, second);
  }
}

}  // namespace penumbra
