#pragma once

#include <optional>

#include "penumbra/scene/scene.h"
#include "penumbra/tracing/hit.h"

namespace penumbra {

/// A triangle of an instance in the world, m.
struct WorldTriangle {
  Vec3d v0, e1, e2;
  /// Half the cross product of its edges: of the front unless the instance mirrors.
  [[nodiscard]] Vec3d area_normal() const { return 0.5 * cross(e1, e2); }
};
[[nodiscard]] WorldTriangle world_triangle(const Instance& instance, const Mesh& mesh, std::uint32_t triangle);

/// Area of an exact shape's surface, m^2; 0 for an infinite plane.
[[nodiscard]] double shape_area(const Shape& shape);

/// A point of a lamp, drawn evenly over its surface.
struct LampPoint {
  SurfacePoint point;
  double density = 0;  ///< 1/m^2
};
/// Of one triangle of an object.
[[nodiscard]] LampPoint point_on_triangle(const Scene& scene, std::uint32_t object, std::uint32_t triangle,
                                          const Vec2d& u);
/// Of an exact shape; none for an infinite plane.
[[nodiscard]] std::optional<LampPoint> point_on_shape(const Scene& scene, std::uint32_t object, const Vec2d& u);

/// What a point of a lamp shines in the mean over the rays that meet it, W/(m^2 sr): nothing in the holes of a mask, in
/// part where it is blended with what lies behind.
[[nodiscard]] Rgb emission_at(const Scene& scene, const SurfacePoint& light);

}  // namespace penumbra
