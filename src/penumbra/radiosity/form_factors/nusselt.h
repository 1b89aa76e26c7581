#pragma once

#include <span>

#include "penumbra/math/vec.h"

namespace penumbra {

/// Form factor from a differential element to a polygon, nothing in between.
///
/// The share (dimensionless, 0..1) of the power leaving a Lambertian element at `point` with unit normal `normal` that
/// arrives at `polygon`: its projected solid angle over pi (Nusselt 1928). Lambert's edge sum (1760) over the polygon
/// clipped at the element's horizon; exact to rounding, also for a polygon that touches the horizon, and 0 for one
/// below it or seen from behind, or one whose plane holds the point. Does not allocate.
/// @pre `polygon` is planar and convex, counter-clockwise seen from the side that radiates.
[[nodiscard]] double point_to_polygon(const Vec3d& point, const Vec3d& normal, std::span<const Vec3d> polygon);

/// Lambert's edge sum without asking on which side of the polygon the point lies: negative when seen from behind. For
/// inner loops that know the polygon faces the point, and for polygons cut out of others.
[[nodiscard]] double signed_point_to_polygon(const Vec3d& point, const Vec3d& normal, std::span<const Vec3d> polygon);

}  // namespace penumbra
