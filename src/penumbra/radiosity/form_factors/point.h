#pragma once

#include <numbers>

#include "penumbra/math/vec.h"

namespace penumbra {

/// The kernel of the form factor, cos(theta) cos(theta') / (pi r^2), 1/m^2, between two surface elements with unit
/// normals; 0 when either faces away or they coincide. Times an area it is the `point` method: its relative error falls
/// with the square of size over distance.
[[nodiscard]] inline double point_kernel(const Vec3d& from, const Vec3d& from_normal, const Vec3d& to,
                                         const Vec3d& to_normal) {
  const Vec3d d = to - from;
  const double cos_from = dot(from_normal, d);
  const double cos_to = -dot(to_normal, d);
  if (!(cos_from > 0 && cos_to > 0)) return 0;
  const double r2 = length_squared(d);
  return cos_from * cos_to / (std::numbers::pi * r2 * r2);
}

}  // namespace penumbra
