#pragma once

#include <limits>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A half-line in world space, metres. `direction` is unit length unless a function says otherwise.
/// Only the open interval (t_min, t_max) counts.
struct Ray {
  Vec3d origin{0};
  Vec3d direction{0, 0, -1};
  double t_min = 0;
  double t_max = std::numeric_limits<double>::infinity();
  double time = 0;  ///< when it is sent: 0 as the shutter opens, 1 as it closes

  [[nodiscard]] Vec3d at(double t) const { return origin + t * direction; }
};

}  // namespace penumbra
