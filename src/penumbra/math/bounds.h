#pragma once

#include <limits>

#include "penumbra/math/vec.h"

namespace penumbra {

/// An axis-aligned box; default-constructed it is empty (lower > upper).
struct Bounds {
  Vec3d lower{std::numeric_limits<double>::infinity()};
  Vec3d upper{-std::numeric_limits<double>::infinity()};

  void grow(const Vec3d& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  void grow(const Bounds& b) {
    lower = glm::min(lower, b.lower);
    upper = glm::max(upper, b.upper);
  }
  [[nodiscard]] bool empty() const { return !(lower.x <= upper.x); }
  [[nodiscard]] Vec3d centre() const { return 0.5 * (lower + upper); }
  [[nodiscard]] Vec3d extent() const { return empty() ? Vec3d(0) : upper - lower; }
  /// Length of the diagonal, metres; 0 when empty.
  [[nodiscard]] double diagonal() const { return glm::length(extent()); }
};

}  // namespace penumbra
