#pragma once

#include <cstdint>

#include "penumbra/math/spectrum.h"
#include "penumbra/tracing/hit.h"

namespace penumbra {

/// Light that is known to arrive at diffuse surfaces: what rendering asks of radiosity. Thread-safe.
class DiffuseLight {
 public:
  /// One side of a surface at a point.
  struct Place {
    const SurfacePoint& point;
    Vec3d side;    ///< unit, the geometric normal of the side
    Vec3d normal;  ///< unit, the shading normal of the side
  };

  virtual ~DiffuseLight() = default;

  /// Irradiance straight from the lamps that are told apart, W/m^2: with sharp shadows.
  /// @param key of the shadow rays, where the light needs some. @param rays how many to a lamp then.
  [[nodiscard]] virtual Rgb direct(const Place& place, std::uint64_t key, std::uint32_t rays) const = 0;
  /// Irradiance from everywhere else, W/m^2.
  [[nodiscard]] virtual Rgb indirect(const Place& place) const = 0;
  /// The part of `indirect` that comes straight from lights by way of mirrors and glass, W/m^2, where it is known
  /// apart: rays that gather the rest need not find it.
  [[nodiscard]] virtual Rgb caustics(const Place& place) const = 0;
  [[nodiscard]] virtual bool knows_caustics() const = 0;
  /// All of it, as smooth as the elements are: for rays that look from afar.
  [[nodiscard]] virtual Rgb total(const Place& place) const = 0;
  /// The distance over which `indirect` and `total` are smooth there, m: the size of the elements.
  [[nodiscard]] virtual double fineness(const Place& place) const = 0;
  /// Whether light that the surface emits there is counted by `direct`.
  [[nodiscard]] virtual bool is_lamp(const Place& place) const = 0;
};

}  // namespace penumbra
