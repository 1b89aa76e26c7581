#include "penumbra/math/polygon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "penumbra/math/bounds.h"

namespace penumbra {
namespace {

std::size_t next(std::size_t i, std::size_t count) { return i + 1 == count ? 0 : i + 1; }

/// The two coordinates that remain when the axis of the largest component of `normal` is dropped, in cyclic order.
std::pair<int, int> projection_axes(const Vec3d& normal) {
  const Vec3d a = glm::abs(normal);
  const int dropped = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return {(dropped + 1) % 3, (dropped + 2) % 3};
}

double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool within_box(const Vec2d& a, const Vec2d& b, const Vec2d& p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

int sign_beyond(double value, double rounding) { return value > rounding ? 1 : value < -rounding ? -1 : 0; }

/// True when segments ab and cd share a point; touching counts.
bool segments_meet(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d, double rounding) {
  const int c_side = sign_beyond(turn(a, b, c), rounding), d_side = sign_beyond(turn(a, b, d), rounding);
  const int a_side = sign_beyond(turn(c, d, a), rounding), b_side = sign_beyond(turn(c, d, b), rounding);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && within_box(a, b, c)) || (d_side == 0 && within_box(a, b, d)) ||
         (a_side == 0 && within_box(c, d, a)) || (b_side == 0 && within_box(c, d, b));
}

/// True when the edges after and before a shared corner fold back onto each other.
bool folds_back(const Vec2d& before, const Vec2d& corner, const Vec2d& after, double rounding) {
  return sign_beyond(turn(before, corner, after), rounding) == 0 && glm::dot(before - corner, after - corner) > 0;
}

}  // namespace

Vec3d newell_vector(std::span<const Vec3d> polygon) {
  Vec3d sum(0);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    sum += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  return sum;
}

double polygon_area(std::span<const Vec3d> polygon) { return 0.5 * length(newell_vector(polygon)); }

Vec3d polygon_normal(std::span<const Vec3d> polygon) {
  const Vec3d n = newell_vector(polygon);
  const double size = length(n);
  return size > 0 ? n / size : Vec3d(0);
}

Vec3d polygon_centroid(std::span<const Vec3d> polygon) {
  const Vec3d normal = polygon_normal(polygon);
  Vec3d moment(0), mean(0);
  double twice_area = 0;
  for (const Vec3d& p : polygon) mean += (p - polygon[0]) / static_cast<double>(polygon.size());
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Vec3d a = polygon[i - 1] - polygon[0], b = polygon[i] - polygon[0];
    const double weight = dot(normal, cross(a, b));
    moment += weight / 3 * (a + b);
    twice_area += weight;
  }
  return polygon[0] + (twice_area > 0 ? moment / twice_area : mean);
}

Plane3 polygon_plane(std::span<const Vec3d> polygon) {
  const Vec3d normal = polygon_normal(polygon);
  return {normal, dot(normal, polygon_centroid(polygon))};
}

double polygon_size(std::span<const Vec3d> polygon) {
  Bounds box;
  for (const Vec3d& p : polygon) box.grow(p);
  return box.diagonal();
}

double planarity_error(std::span<const Vec3d> polygon) {
  if (polygon.size() < 4) return 0;
  const Vec3d normal = polygon_normal(polygon);
  double mean = 0, worst = 0;
  for (const Vec3d& p : polygon) mean += dot(normal, p - polygon[0]) / static_cast<double>(polygon.size());
  for (const Vec3d& p : polygon) worst = std::max(worst, std::abs(dot(normal, p - polygon[0]) - mean));
  return worst;
}

bool is_convex(std::span<const Vec3d> polygon) {
  const std::size_t count = polygon.size();
  if (count < 3) return false;
  if (count == 3) return true;
  const Vec3d normal = polygon_normal(polygon);
  double total_turn = 0;  // of the direction along the outline; 2 pi when it goes round once
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d in = polygon[i] - polygon[i == 0 ? count - 1 : i - 1];
    const Vec3d out = polygon[next(i, count)] - polygon[i];
    const double sine = dot(normal, cross(in, out));
    if (sine < -1e-12 * length(in) * length(out)) return false;
    total_turn += std::atan2(sine, dot(in, out));
  }
  return total_turn < 9;  // between once (6.28) and twice (12.57)
}

bool is_self_intersecting(std::span<const Vec3d> polygon) {
  const std::size_t count = polygon.size();
  if (count < 4) return false;
  const auto [x, y] = projection_axes(newell_vector(polygon));
  const double size = polygon_size(polygon);
  const double rounding = 1e-14 * size * size;
  const auto flat = [&, ax = x, ay = y](std::size_t i) {
    const Vec3d p = polygon[i] - polygon[0];
    return Vec2d(p[ax], p[ay]);
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2d a = flat(i), b = flat(next(i, count));
    if (folds_back(a, b, flat((i + 2) % count), rounding)) return true;
    for (std::size_t k = i + 2; k < count; ++k) {
      if (next(k, count) == i) continue;  // neighbours share a corner
      if (segments_meet(a, b, flat(k), flat(next(k, count)), rounding)) return true;
    }
  }
  return false;
}

bool convex_contains(std::span<const Vec3d> polygon, const Vec3d& point) {
  const Vec3d normal = newell_vector(polygon);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d& a = polygon[i];
    if (dot(normal, cross(polygon[next(i, polygon.size())] - a, point - a)) < 0) return false;
  }
  return polygon.size() >= 3;
}

void clip_polygon(std::span<const Vec3d> polygon, const Plane3& half_space, double tolerance, std::vector<Vec3d>& out) {
  out.clear();
  const std::size_t count = polygon.size();
  bool any_in_front = false;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d &a = polygon[i], &b = polygon[next(i, count)];
    const double da = half_space.distance(a), db = half_space.distance(b);
    any_in_front = any_in_front || da > tolerance;
    if (da >= -tolerance) out.push_back(a);
    const bool crosses = (da > tolerance && db < -tolerance) || (da < -tolerance && db > tolerance);
    if (crosses) out.push_back(a + da / (da - db) * (b - a));
  }
  if (!any_in_front) out.clear();
}

void project_polygon(std::span<const Vec3d> polygon, const Plane3& plane, std::vector<Vec3d>& out) {
  out.clear();
  for (const Vec3d& p : polygon) out.push_back(p - plane.distance(p) * plane.normal);
}

void project_polygon_2d(std::span<const Vec3d> polygon, const Vec3d& origin, const Vec3d& x_axis, const Vec3d& y_axis,
                        std::vector<Vec2d>& out) {
  out.clear();
  for (const Vec3d& p : polygon) out.push_back({dot(x_axis, p - origin), dot(y_axis, p - origin)});
}

}  // namespace penumbra
