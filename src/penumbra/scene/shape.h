#pragma once

#include <string>
#include <variant>

#include "penumbra/math/vec.h"

namespace penumbra {

// Exact primitives in world space, metres. The front is the side the normal points to.

/// Normal outwards.
struct Sphere {
  Vec3d centre{0};
  double radius = 1;
};

struct Disk {
  Vec3d centre{0};
  Vec3d normal{0, 1, 0};  ///< unit
  double radius = 1;
};

/// Open at both ends; normal away from the axis.
struct Cylinder {
  Vec3d base{0};
  Vec3d top{0, 1, 0};
  double radius = 1;
};

/// Without end.
struct Plane {
  Vec3d point{0};
  Vec3d normal{0, 1, 0};  ///< unit
};

using Shape = std::variant<Sphere, Disk, Cylinder, Plane>;

}  // namespace penumbra
