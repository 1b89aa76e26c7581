#pragma once

#include <cstdint>
#include <span>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A rectangle in the plane of a chart that holds all of it, u along its longer side. Seen from the front with u to the
/// right, v points down.
struct ChartPlane {
  Vec3d origin{0};    ///< m, the corner where u and v are 0
  Vec3d u{1, 0, 0};   ///< unit
  Vec3d v{0, -1, 0};  ///< unit
  Vec2d size{0};      ///< m; the shorter side is 0 for points in a line

  /// The point's place in the rectangle, m.
  [[nodiscard]] Vec2d project(const Vec3d& p) const { return {dot(p - origin, u), dot(p - origin, v)}; }
};

/// The smallest rectangle around the points, in the plane across `normal`; of rectangles about as small, the one along
/// the longest edge of the points' hull. @param normal the front's, of any length; zero for points in a line.
/// @pre there is a point.
[[nodiscard]] ChartPlane chart_plane(std::span<const Vec3d> points, const Vec3d& normal);

}  // namespace penumbra
