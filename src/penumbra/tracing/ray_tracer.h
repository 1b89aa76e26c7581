#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "penumbra/math/ray.h"
#include "penumbra/scene/scene.h"
#include "penumbra/tracing/hit.h"

namespace penumbra {

/// Sixteen rays side by side, single precision, for coherent work such as the tiles of a picture.
struct alignas(64) RayPacket {
  static constexpr int size = 16;
  float origin_x[size], origin_y[size], origin_z[size];
  float t_min[size];
  float direction_x[size], direction_y[size], direction_z[size];
  float t_max[size];
  std::int32_t active[size];  ///< -1 to trace this lane, 0 to skip it
};

/// What a packet hit; `object` is `no_hit` in lanes that missed or were skipped.
struct alignas(64) HitPacket {
  static constexpr std::uint32_t no_hit = 0xFFFFFFFFU;
  float t[RayPacket::size];
  float normal_x[RayPacket::size], normal_y[RayPacket::size],
      normal_z[RayPacket::size];  ///< geometric, towards the front, not unit
  float u[RayPacket::size], v[RayPacket::size];
  std::uint32_t object[RayPacket::size];
  std::uint32_t primitive[RayPacket::size];
};

/// Finds what rays meet: a bounding volume hierarchy over a scene, watertight between triangles that share an edge. (A
/// ray aimed exactly at a shared vertex slips through about three times in ten thousand: Embree's robust test rounds
/// there.)
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
  void nearest(const RayPacket& rays, HitPacket& hits) const;
  /// Sets `active` to 0 in lanes where something stands in the way.
  /// @param coherent whether the rays run close together (to one point, say); spread ones are faster without.
  void occluded(RayPacket& rays, bool coherent) const;

  /// Position, normals, texture coordinates and material at a hit of `ray`.
  [[nodiscard]] SurfacePoint surface_point(const Ray& ray, const Hit& hit) const;

  /// World bounds of all that is finite.
  [[nodiscard]] Bounds bounds() const;
  /// Triangles in the hierarchy, instances counted each time.
  [[nodiscard]] std::size_t triangle_count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace penumbra
