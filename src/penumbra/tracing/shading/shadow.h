#pragma once

#include "penumbra/math/bands.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/interior.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {

/// What stands between a point and a light, for shadow rays.
///
/// Opaque surfaces stop them. Surfaces of AlphaMode::blend let 1 - alpha pass. Glass either stops them too, or
/// attenuates them straight through by Fresnel and absorption: an approximation (no refraction, so no caustics) that
/// Whitted's shadow rays have been given since 1979. Participating media attenuate on the way (Beer-Lambert), so that
/// they cast shadows.
class Shadow {
 public:
  /// @param through_glass whether transparent surfaces let shadow rays pass.
  Shadow(const RayTracer& tracer, bool through_glass);

  /// The share of light that passes along the ray's interval, 0..1 per band.
  /// @param inside the closed surfaces that the ray starts in, as far as media matter.
  [[nodiscard]] Rgb transmittance(const Ray& ray, const Interior& inside = {}, const Bands& bands = {}) const;

  /// Whether light may pass the surface that a packet's lane hit.
  [[nodiscard]] bool passes(const HitPacket& hits, int lane) const;

  /// True when every surface is opaque and the air is clear, so that one occlusion query decides.
  [[nodiscard]] bool is_binary() const { return binary_ && media_.none(); }
  [[nodiscard]] const Media& media() const { return media_; }

 private:
  struct Passage;
  [[nodiscard]] bool go_through(Passage& way, const Hit& hit, const Bands& bands) const;

  const RayTracer* tracer_;
  Media media_;
  bool through_glass_;
  bool binary_;
};

}  // namespace penumbra
