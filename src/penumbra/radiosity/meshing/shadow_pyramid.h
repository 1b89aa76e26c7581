#pragma once

#include <span>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"

namespace penumbra {

/// The pyramid over a polygon with its apex at a point, without end: half-spaces through the apex and each edge, their
/// fronts inside. Empty when the polygon is seen from its edge.
/// @pre `polygon` is planar and convex.
[[nodiscard]] std::vector<Plane3> pyramid_over(std::span<const Vec3d> polygon, const Vec3d& apex);

/// Whether all of a box lies behind one of the half-spaces, or less than `tolerance` (m) in front of it.
[[nodiscard]] bool is_outside(const Bounds& box, std::span<const Plane3> half_spaces, double tolerance);

/// Cuts the pyramid over `blocker` seen from `point` out of convex pieces: what is left of a lamp behind a polygon.
/// @pre `blocker` is planar and convex and lies between point and pieces.
void cut_shadow(const Vec3d& point, std::span<const Vec3d> blocker, std::vector<std::vector<Vec3d>>& pieces);

}  // namespace penumbra
