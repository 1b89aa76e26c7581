#pragma once

#include "penumbra/math/vec.h"

namespace penumbra {

/// Maps the unit square to the unit disk, area-preserving and continuous (Shirley & Chiu 1997).
[[nodiscard]] Vec2d sample_disk(const Vec2d& u);

/// A direction of the upper hemisphere (local, z up) with density cos(theta)/pi (Malley's method).
[[nodiscard]] Vec3d sample_cosine_hemisphere(const Vec2d& u);

/// A direction of the sphere with density 1/(4 pi).
[[nodiscard]] Vec3d sample_sphere(const Vec2d& u);

/// A direction within `cos_max` of +z, with density 1/(2 pi (1 - cos_max)).
[[nodiscard]] Vec3d sample_cone(const Vec2d& u, double cos_max);

/// Barycentric weights of vertices 1 and 2, uniform over a triangle's area.
[[nodiscard]] Vec2d sample_triangle(const Vec2d& u);

/// Of two ways to find the same thing, the share of one with density `a` (Veach & Guibas 1995, power heuristic,
/// exponent 2).
[[nodiscard]] inline double power_heuristic(double a, double b) { return a * a / (a * a + b * b); }

}  // namespace penumbra
