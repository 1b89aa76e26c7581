#include "penumbra/baking/chart_plane.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "penumbra/math/frame.h"

namespace penumbra {
namespace {

double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Andrew 1979: the convex hull, counter-clockwise; one or two points when there are no more.
std::vector<Vec2d> convex_hull(std::vector<Vec2d> points) {
  std::ranges::sort(points, [](const Vec2d& a, const Vec2d& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2d> hull;
  for (const bool back : {false, true}) {
    const std::size_t start = hull.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2d& p = back ? points[points.size() - 1 - i] : points[i];
      while (hull.size() >= start + 2 && !(turn(hull[hull.size() - 2], hull.back(), p) > 0)) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
  }
  return hull;
}

struct Extent {
  Vec2d lower{0}, size{0};
};

Extent extent_along(const std::vector<Vec2d>& hull, const Vec2d& direction) {
  const Vec2d across(-direction.y, direction.x);
  Vec2d lower(glm::dot(hull[0], direction), glm::dot(hull[0], across)), upper = lower;
  for (const Vec2d& p : hull) {
    const Vec2d q(glm::dot(p, direction), glm::dot(p, across));
    lower = glm::min(lower, q);
    upper = glm::max(upper, q);
  }
  return {lower, upper - lower};
}

/// The direction of the hull's edge along which the rectangle is smallest (Freeman & Shapira 1975).
Vec2d best_direction(const std::vector<Vec2d>& hull) {
  constexpr double alike = 1e-3;  // areas that differ by less are equal, and the longer edge decides
  Vec2d best(1, 0);
  double best_area = 0, best_edge = 0;
  for (std::size_t i = 0; i < hull.size() && hull.size() > 1; ++i) {
    const Vec2d edge = hull[(i + 1) % hull.size()] - hull[i];
    const double size = glm::length(edge);
    if (!(size > 0)) continue;
    const Vec2d rectangle = extent_along(hull, edge / size).size;
    const double area = rectangle.x * rectangle.y;
    const bool smaller = area < (1 - alike) * best_area;
    const bool longer = area <= (1 + alike) * best_area && size > (1 + 1e-6) * best_edge;
    if (best_edge > 0 && !smaller && !longer) continue;
    best = edge / size;
    best_area = area;
    best_edge = size;
  }
  return best;
}

/// Of a direction and its reverse, the one whose largest component is positive: charts lie alike.
Vec3d forwards(const Vec3d& d) {
  const Vec3d a = glm::abs(d);
  const int largest = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
  return d[largest] < 0 ? -d : d;
}

Vec3d line_normal(std::span<const Vec3d> points) {
  Vec3d along(0);
  for (const Vec3d& p : points) {
    if (length(p - points[0]) > length(along)) along = p - points[0];
  }
  return length(along) > 0 ? Frame(normalize(along)).tangent : Vec3d(0, 0, 1);
}

}  // namespace

ChartPlane chart_plane(std::span<const Vec3d> points, const Vec3d& normal) {
  const Frame frame(length(normal) > 0 ? normalize(normal) : line_normal(points));
  std::vector<Vec2d> flat;
  flat.reserve(points.size());
  for (const Vec3d& p : points) {
    flat.emplace_back(dot(p - points[0], frame.tangent), dot(p - points[0], frame.bitangent));
  }
  const std::vector<Vec2d> hull = convex_hull(std::move(flat));
  Vec2d direction = best_direction(hull);
  const Vec2d size = extent_along(hull, direction).size;
  if (size.y > size.x) direction = {-direction.y, direction.x};

  ChartPlane plane;
  plane.u = forwards(direction.x * frame.tangent + direction.y * frame.bitangent);
  plane.v = cross(plane.u, frame.normal);
  Vec2d lower(dot(points[0], plane.u), dot(points[0], plane.v)), upper = lower;
  for (const Vec3d& p : points) {
    const Vec2d q(dot(p, plane.u), dot(p, plane.v));
    lower = glm::min(lower, q);
    upper = glm::max(upper, q);
  }
  plane.size = upper - lower;
  plane.origin = lower.x * plane.u + lower.y * plane.v + dot(points[0], frame.normal) * frame.normal;
  return plane;
}

}  // namespace penumbra
