#include "penumbra/radiosity/form_factors/nusselt.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "penumbra/math/polygon.h"

namespace penumbra {
namespace {

/// Lambert's term of one edge seen from the origin: the angle it subtends times the unit normal of the plane through it
/// and the eye, projected onto `normal`. 0 for an edge in line with the eye.
double edge_term(const Vec3d& normal, const Vec3d& a, const Vec3d& b) {
  const Vec3d axis = cross(a, b);
  const double sine = length(axis);
  return sine > 0 ? std::atan2(sine, dot(a, b)) / sine * dot(normal, axis) : 0;
}

}  // namespace

double signed_point_to_polygon(const Vec3d& point, const Vec3d& normal, std::span<const Vec3d> polygon) {
  if (polygon.size() < 3) return 0;
  double sum = 0;
  Vec3d a = polygon.back() - point;
  double a_height = dot(normal, a);
  Vec3d left_at{0}, came_at{0};  // where the outline goes below the horizon and where it comes up again
  bool left = false, came = false;
  for (const Vec3d& corner : polygon) {
    const Vec3d b = corner - point;
    const double b_height = dot(normal, b);
    if (a_height >= 0 && b_height >= 0) {
      sum += edge_term(normal, a, b);
    } else if (a_height > 0 || b_height > 0) {
      const Vec3d at_horizon = a + a_height / (a_height - b_height) * (b - a);
      if (a_height > 0) {
        sum += edge_term(normal, a, at_horizon);
        left_at = at_horizon;
        left = true;
      } else {
        sum += edge_term(normal, at_horizon, b);
        came_at = at_horizon;
        came = true;
      }
    } else if (a_height == 0 && b_height < 0) {  // a corner on the horizon itself
      left_at = a;
      left = true;
    } else if (b_height == 0 && a_height < 0) {
      came_at = b;
      came = true;
    }
    a = b;
    a_height = b_height;
  }
  if (left && came) sum += edge_term(normal, left_at, came_at);
  // Seen from the front the corners run counter-clockwise, and Lambert's sum comes out negative.
  return -sum / (2 * std::numbers::pi);
}

double point_to_polygon(const Vec3d& point, const Vec3d& normal, std::span<const Vec3d> polygon) {
  if (polygon.size() < 3) return 0;
  if (dot(newell_vector(polygon), point - polygon[0]) <= 0) return 0;
  return std::clamp(signed_point_to_polygon(point, normal, polygon), 0.0, 1.0);
}

}  // namespace penumbra
