#pragma once

#include <array>
#include <cstddef>

#include "penumbra/math/bounds.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// The convex hull of two boxes: all segments between them lie inside (Haines & Wallace 1991).
///
/// Bounded by the box around both and by planes parallel to an axis that touch one edge of each box.
class Shaft {
 public:
  Shaft(const Bounds& a, const Bounds& b);

  /// True when the box lies wholly outside. False may be wrong.
  [[nodiscard]] bool misses(const Bounds& box) const;

 private:
  struct Line {  // u * p[axis_u] + v * p[axis_v] <= limit inside
    int axis_u = 0, axis_v = 1;
    double u = 0, v = 0, limit = 0;
  };
  Bounds hull_;
  std::array<Line, 24> lines_;
  std::size_t count_ = 0;
};

}  // namespace penumbra
