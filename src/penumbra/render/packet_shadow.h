#pragma once

#include "penumbra/render/packet_surfaces.h"
#include "penumbra/tracing/shading/shadow.h"

namespace penumbra {

/// What stands between sixteen points and a light: Shadow, lane by lane, with clear glass crossed side by side.
class PacketShadow {
 public:
  /// All must outlive it.
  PacketShadow(const RayTracer& tracer, const PacketSurfaces& surfaces, const Shadow& shadow)
      : tracer_(tracer), surfaces_(surfaces), shadow_(shadow) {}

  /// The share of light that passes along the active lanes; lanes along which nothing passes fall asleep, and hold 1.
  /// @param coherent see RayTracer::occluded. @pre shadow.media().none().
  void transmittance(RayPacket& rays, bool coherent, ColourLanes& passed) const;

 private:
  struct Passage;
  void go_through(Passage& way, RayPacket& rays, ColourLanes& passed) const;

  const RayTracer& tracer_;
  const PacketSurfaces& surfaces_;
  const Shadow& shadow_;
};

}  // namespace penumbra
