#pragma once

#include <cmath>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A right-handed orthonormal frame whose z axis is `normal`.
///
/// Branchless construction after Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
struct Frame {
  Vec3d tangent{1, 0, 0};
  Vec3d bitangent{0, 1, 0};
  Vec3d normal{0, 0, 1};

  Frame() = default;
  /// @pre `n` is unit length.
  explicit Frame(const Vec3d& n) : normal(n) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    tangent = {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }

  [[nodiscard]] Vec3d to_local(const Vec3d& v) const {
    return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)};
  }
  [[nodiscard]] Vec3d to_world(const Vec3d& v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
};

}  // namespace penumbra
