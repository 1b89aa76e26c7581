#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "penumbra/math/ray.h"
#include "penumbra/scene/scene.h"
#include "penumbra/tracing/hit.h"
#include "penumbra/tracing/ray_packet.h"

namespace penumbra {

/// Finds what rays meet: a bounding volume hierarchy over a scene, watertight between triangles that share an edge. (A
/// ray aimed exactly at a shared vertex slips through about three times in ten thousand: Embree's robust test rounds
/// there.) Planes, and exact shapes that are few, are tried one by one beside it, which is faster.
///
/// All member functions are thread-safe. The scene must outlive the tracer and stay unchanged.
class RayTracer {
 public:
  /// Builds the hierarchy on every thread allowed. Throws std::bad_alloc when memory runs out.
  explicit RayTracer(const Scene& scene);
  ~RayTracer();
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;

  [[nodiscard]] const Scene& scene() const;

  /// The nearest surface within (t_min, t_max); holes of AlphaMode::mask do not count.
  [[nodiscard]] std::optional<Hit> nearest(const Ray& ray) const;
  /// Whether anything stands within (t_min, t_max).
  [[nodiscard]] bool occluded(const Ray& ray) const;

  /// Nearest hits of the active lanes; coherent rays gain most.
  /// @param coherent whether the rays run close together (to one point, say); spread ones are faster without.
  void nearest(const RayPacket& rays, HitPacket& hits, bool coherent = true) const;
  /// Sets `active` to 0 in lanes where something stands in the way.
  void occluded(RayPacket& rays, bool coherent) const;

  /// Position, normals, texture coordinates and material at a hit of `ray`.
  [[nodiscard]] SurfacePoint surface_point(const Ray& ray, const Hit& hit) const;

  /// How texture coordinates and normal change when `point` moves by `step` over its surface, to first order.
  /// @param step m, tangent to the geometry.
  [[nodiscard]] SurfaceChange surface_change(const SurfacePoint& point, const Vec3d& step) const;

  /// The vertices of an instance in the world, single precision, in the order of its mesh; empty where the hierarchy
  /// has none: of instances that move or share their mesh with others.
  [[nodiscard]] std::span<const Vec3f> world_vertices(std::uint32_t object) const;

  /// Whether any object moves while the shutter is open: rays then see it by their time.
  [[nodiscard]] bool has_motion() const;

  /// World bounds of all that is finite, wherever it moves.
  [[nodiscard]] Bounds bounds() const;
  /// Triangles in the hierarchy, instances counted each time.
  [[nodiscard]] std::size_t triangle_count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace penumbra
