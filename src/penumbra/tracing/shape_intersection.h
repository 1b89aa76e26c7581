#pragma once

#include <optional>

#include "penumbra/math/bounds.h"
#include "penumbra/math/ray.h"
#include "penumbra/scene/shape.h"
#include "penumbra/tracing/hit.h"

namespace penumbra {

/// Distance to the first crossing of an exact shape within (t_min, t_max), in double precision. `ray.direction` need
/// not be unit length; the distance is then in its lengths.
[[nodiscard]] std::optional<double> intersect(const Sphere& sphere, const Ray& ray);
[[nodiscard]] std::optional<double> intersect(const Disk& disk, const Ray& ray);
[[nodiscard]] std::optional<double> intersect(const Cylinder& cylinder, const Ray& ray);
[[nodiscard]] std::optional<double> intersect(const Plane& plane, const Ray& ray);

/// The differential geometry of a shape at a point on (or within rounding of) it.
struct ShapePoint {
  Vec3d position;  ///< moved onto the shape
  Vec3d normal;    ///< unit, towards the front
  Vec3d tangent;   ///< unit, along increasing u
  Vec2f uv;        ///< 0..1 over the shape; metres on a plane
};
/// @param with_uv whether texture coordinates are worked out, else those that need angles are 0 and tangents may lie
/// any way.
[[nodiscard]] ShapePoint shape_point(const Shape& shape, const Vec3d& near, bool with_uv = true);

/// How texture coordinates and normal change along a small step over a shape. @param step m, tangent at `from`.
[[nodiscard]] SurfaceChange shape_change(const Shape& shape, const Vec3d& from, const Vec3d& step);

/// Its normal alone, towards the front, not unit: all that a packet's hit needs, and much cheaper.
[[nodiscard]] Vec3d shape_normal(const Shape& shape, const Vec3d& near);

/// World bounds; a plane's are cut at `horizon` metres from its point.
[[nodiscard]] Bounds shape_bounds(const Shape& shape, double horizon);

}  // namespace penumbra
