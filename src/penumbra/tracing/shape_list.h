#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "penumbra/math/ray.h"
#include "penumbra/scene/shape.h"
#include "penumbra/tracing/ray_packet.h"
#include "penumbra/tracing/sphere_groups.h"

namespace penumbra {

/// A short list of exact shapes, met one after the other without a hierarchy: for a few dozen spheres that is faster,
/// since sixteen rays, or sixteen spheres, are tried at once.
///
/// Spheres are sifted by groups first, see SphereGroups; what passes is intersected in double precision as `intersect`
/// does, to the same bits.
class ShapeList {
 public:
  /// Up to how many spheres the list is the faster way (measured, bench/render).
  static constexpr std::size_t longest = 64;

  /// @param object its number in the scene.
  void add(const Shape& shape, std::uint32_t object);
  [[nodiscard]] bool empty() const { return spheres_.entries.empty() && planes_.empty() && others_.empty(); }

  struct Crossing {
    double t = 0;  ///< along the ray, m
    std::uint32_t object = 0;
  };
  /// The nearest crossing within (t_min, t_max).
  [[nodiscard]] std::optional<Crossing> nearest(const Ray& ray) const;
  [[nodiscard]] bool occluded(const Ray& ray) const;

  /// Sets `object`, `t` and the normal of active lanes that meet a shape, and no_hit in all other lanes, whose `t` is
  /// the ray's t_max.
  void nearest(const RayPacket& rays, HitPacket& hits) const;
  /// Sets `active` to 0 in lanes where a shape stands in the way.
  void occluded(RayPacket& rays) const;

  struct PlaneEntry {
    Plane plane;
    std::uint32_t object;
  };
  struct OtherEntry {
    Shape shape;
    std::uint32_t object;
  };

 private:
  SphereGroups spheres_;
  std::vector<PlaneEntry> planes_;
  std::vector<OtherEntry> others_;
};

}  // namespace penumbra
