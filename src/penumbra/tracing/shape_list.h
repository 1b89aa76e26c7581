#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "penumbra/math/ray.h"
#include "penumbra/scene/shape.h"
#include "penumbra/tracing/ray_packet.h"

namespace penumbra {

/// A short list of exact shapes, met one after the other without a hierarchy: for a few dozen spheres that is faster,
/// since sixteen rays, or sixteen spheres, are tried at once.
///
/// Spheres stand in groups of neighbours. Groups, then their spheres, are sifted in single precision by a test that
/// never loses one that is met; what passes is intersected in double precision as `intersect` does, to the same bits.
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

  /// What the sieve knows of sixteen spheres: one that the line origin + t direction, |direction| = 1, meets has
  ///   o.o (1 - slack) + o.m - (o.d - c.d)^2 <= reach,   m = -2 c.
  struct alignas(64) Sieve {
    static constexpr std::size_t size = 16;
    float centre_x[size], centre_y[size], centre_z[size];
    float minus_x[size], minus_y[size], minus_z[size];  // m
    float reach[size];                                  // r^2 - c.c + slack
  };
  struct SphereEntry {
    Sphere sphere;
    std::uint32_t object;
  };
  /// Neighbours: spheres [first, first + count) in the list's order.
  struct Group {
    Sieve sieve;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  struct Spheres {
    std::vector<Sieve> around;  ///< balls around the groups, sixteen each
    std::vector<Group> groups;
    std::vector<SphereEntry> entries;
  };
  struct PlaneEntry {
    Plane plane;
    std::uint32_t object;
  };
  struct OtherEntry {
    Shape shape;
    std::uint32_t object;
  };

 private:
  void arrange();
  void split(std::uint32_t first, std::uint32_t last);

  Spheres spheres_;
  std::vector<PlaneEntry> planes_;
  std::vector<OtherEntry> others_;
};

}  // namespace penumbra
