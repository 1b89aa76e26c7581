#pragma once

#include "penumbra/render/packet_shading.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {

/// A rough layer over a matt base, as Bsdf has it: GGX with Schlick's Fresnel term, and what it leaves to the base by
/// the cosine of a direction.
struct GlossLayer {
  /// Nodes over the root of the cosine, between which the albedo's table is straight.
  static constexpr int nodes = 32;

  float alpha = 1;             ///< width of GGX
  Rgb head_on{0};              ///< reflectance at normal incidence
  float grazing = 0;           ///< at grazing incidence
  float inverse_open = 1;      ///< 1 over the mean of `left`
  float left[nodes + 1] = {};  ///< 1 less the layer's albedo; the last node twice

  /// @pre a dielectric, neither metallic nor transparent, with specular > 0.
  explicit GlossLayer(const Material& material);

  [[nodiscard]] float left_at(float cosine) const;
};

/// The layers of sixteen surfaces. Where there is none it reflects nothing and leaves all.
struct alignas(64) GlossLanes {
  Lanes alpha;
  ColourLanes head_on;
  Lanes grazing;
  std::array<const GlossLayer*, RayPacket::size> layer{};
  Lanes left;  ///< to the base of light that goes to the eye, over the mean

  /// @param facing cosine of the normal with the way to the eye.
  void set(std::size_t lane, const GlossLayer* layer, float facing);
};

/// Light that layers and the matt bases below send on: as add_light, with reflection / pi and gloss instead of
/// reflectance / pi.
void add_glossy_light(const RayPacket& rays, const PointLanes& points, const GlossLanes& gloss,
                      const ColourLanes& reflectance, const ColourLanes& light, const ColourLanes& passed,
                      const Lanes& geometry, const RayPacket& shadow, ColourLanes& radiance);

}  // namespace penumbra
