#include "penumbra/radiosity/meshing/shadow_pyramid.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

std::vector<Plane3> pyramid_over(std::span<const Vec3d> polygon, const Vec3d& apex) {
  std::vector<Plane3> planes;
  const Vec3d front = newell_vector(polygon);
  const double side = dot(front, polygon[0] - apex);
  if (std::abs(side) <= 1e-12 * length(front) * polygon_size(polygon)) return planes;
  const double turn = side > 0 ? 1 : -1;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3d inward = turn * cross(polygon[k] - apex, polygon[(k + 1) % polygon.size()] - apex);
    const double size = length(inward);
    if (!(size > 0)) continue;
    planes.push_back({inward / size, dot(inward, apex) / size});
  }
  return planes;
}

bool is_outside(const Bounds& box, std::span<const Plane3> half_spaces, double tolerance) {
  return std::any_of(half_spaces.begin(), half_spaces.end(), [&](const Plane3& s) {
    const Vec3d farthest(s.normal.x > 0 ? box.upper.x : box.lower.x, s.normal.y > 0 ? box.upper.y : box.lower.y,
                         s.normal.z > 0 ? box.upper.z : box.lower.z);
    return s.distance(farthest) <= tolerance;
  });
}

void cut_shadow(const Vec3d& point, std::span<const Vec3d> blocker, std::vector<std::vector<Vec3d>>& pieces) {
  const std::vector<Plane3> pyramid = pyramid_over(blocker, point);
  if (pyramid.empty()) return;  // seen from the edge
  std::vector<std::vector<Vec3d>> left;
  std::vector<Vec3d> outside, inside;
  for (std::vector<Vec3d>& rest : pieces) {
    for (const Plane3& inner : pyramid) {
      if (rest.size() < 3) break;
      clip_polygon(rest, {-inner.normal, -inner.offset}, 0, outside);
      if (outside.size() >= 3) left.push_back(outside);
      clip_polygon(rest, inner, 0, inside);
      std::swap(rest, inside);
    }
  }
  pieces.swap(left);
}

}  // namespace penumbra
