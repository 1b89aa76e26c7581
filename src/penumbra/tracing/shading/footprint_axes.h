#pragma once

#include <algorithm>
#include <cmath>

#include "penumbra/math/vec.h"

namespace penumbra {

/// The long and the short axis of a footprint: the ellipse with the second moments of the parallelogram that its two
/// steps span.
struct FootprintAxes {
  Vec2d major{0}, minor{0};  ///< as long as the steps of a footprint that lies along them
  double major_length = 0, minor_length = 0;
};

/// By the eigenvalues and vectors of x x^T + y y^T.
[[nodiscard]] inline FootprintAxes axes_of(const Vec2d& x, const Vec2d& y) {
  const double a = x.x * x.x + y.x * y.x;
  const double b = x.x * x.y + y.x * y.y;
  const double c = x.y * x.y + y.y * y.y;
  const double root = std::hypot((a - c) / 2, b);
  FootprintAxes axes;
  axes.major_length = std::sqrt((a + c) / 2 + root);
  // By the determinant: the difference of the two would lose a thin footprint's width to rounding.
  axes.minor_length = axes.major_length > 0 ? std::abs(x.x * y.y - x.y * y.x) / axes.major_length : 0;
  const Vec2d along = a > c ? Vec2d((a - c) / 2 + root, b) : Vec2d(b, (c - a) / 2 + root);
  const double size = length(along);
  const Vec2d direction = size > 0 ? along / size : Vec2d(1, 0);
  axes.major = axes.major_length * direction;
  axes.minor = axes.minor_length * Vec2d(-direction.y, direction.x);
  return axes;
}

}  // namespace penumbra
