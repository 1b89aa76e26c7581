#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "penumbra/math/frame.h"
#include "penumbra/math/ray.h"

namespace penumbra {

/// Rounding of one coordinate through single precision, relative to the numbers' size: vertices and ray origins are
/// each rounded to float (half an ulp), and the robust intersector works on their float differences. 8 units cover the
/// sum with a margin of two; rays that start on a surface then find themselves on the right side of it.
inline constexpr double float_error = 8 * 0x1p-24;

[[nodiscard]] inline double largest_component(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The bound for numbers up to `size`, the same on all three coordinates: on a triangle that lies along an axis one
/// coordinate has no rounding at all, and a ray that starts exactly in its plane would hit it at distance 0.
[[nodiscard]] inline Vec3d rounding_error(double size) { return Vec3d(float_error * size); }

/// Where a ray meets a surface, as the tracer finds it.
struct Hit {
  double t = 0;                 ///< distance along the ray, m
  std::uint32_t object = 0;     ///< numbered as in Scene
  std::uint32_t primitive = 0;  ///< triangle of the mesh; 0 for exact shapes
  Vec2d barycentric{0};         ///< weights of vertices 1 and 2; unused for exact shapes
};

/// The surface around a hit, world space.
struct SurfacePoint {
  Vec3d position{0};
  Vec3d error{0};                   ///< bound on each coordinate's rounding error, m
  Vec3d geometric_normal{0, 0, 1};  ///< unit, towards the front, whatever side was hit
  Vec3d shading_normal{0, 0, 1};    ///< unit, interpolated, in the geometric normal's hemisphere
  Vec3d tangent{1, 0, 0};           ///< unit, along increasing u, perpendicular to the shading normal
  Vec3d bitangent{0, 1, 0};         ///< unit, normal-map +Y (up in texture space), perpendicular to both
  Vec2f uv[2]{};
  Vec4f colour{1};  ///< vertex colour, linear, alpha in w
  std::uint32_t object = 0;
  std::uint32_t primitive = 0;
  std::uint32_t material = 0;
  double time = 0;  ///< of the ray that met it, as Ray::time; rays that leave from here take it along
};

/// How a surface changes along a small step over it.
struct SurfaceChange {
  Vec2d uv[2]{Vec2d(0), Vec2d(0)};
  Vec3d normal{0};  ///< of the unit shading normal, before normal maps
};

/// A ray that leaves a surface without meeting it again: the origin is moved out of the point's error box to the side
/// that `direction` points to (after Pharr, Jakob & Humphreys, "Physically Based Rendering", 4th ed., 6.8.6).
[[nodiscard]] Ray leave(const SurfacePoint& from, const Vec3d& direction);

/// The open segment between a surface and a point in space, for shadow rays; `direction` is unit length.
[[nodiscard]] Ray segment(const SurfacePoint& from, const Vec3d& target);

/// The open segment between two surfaces: both ends are moved out of their error boxes, each to the side of the other,
/// so that it meets neither surface, however flat it lies on them.
[[nodiscard]] Ray segment(const SurfacePoint& from, const SurfacePoint& target);

}  // namespace penumbra
