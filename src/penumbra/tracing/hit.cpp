#include "penumbra/tracing/hit.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

// How far along the normal a point must move to leave its error box, whatever the direction.
double clearance(const Vec3d& normal, const Vec3d& error) { return dot(glm::abs(normal), error); }

}  // namespace

Ray leave(const SurfacePoint& from, const Vec3d& direction) {
  const double side = dot(direction, from.geometric_normal) < 0 ? -1.0 : 1.0;
  return {.origin = from.position + side * clearance(from.geometric_normal, from.error) * from.geometric_normal,
          .direction = direction,
          .time = from.time};
}

Ray segment(const SurfacePoint& from, const Vec3d& target) {
  Ray ray = leave(from, target - from.position);
  const Vec3d way = target - ray.origin;
  const double distance = length(way);
  ray.direction = distance > 0 ? way / distance : from.geometric_normal;
  ray.t_max = distance * (1 - 4 * 0x1p-24);  // single precision rounds the end too
  return ray;
}

Ray segment(const SurfacePoint& from, const SurfacePoint& target) {
  const Vec3d back = from.position - target.position;
  SurfacePoint end = target;
  // The ray comes with its origin's rounding, its direction's, and that of the vertices as seen from its origin.
  end.error += from.error + Vec3d(8 * 0x1p-24 * length(back));
  return segment(from, leave(end, back).origin);
}

}  // namespace penumbra
