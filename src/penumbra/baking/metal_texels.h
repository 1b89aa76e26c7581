#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/baking/atlas_space.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {

/// Whether a material is opaque and, in part at least, metal.
[[nodiscard]] bool is_opaque_metal(const Material& m);

/// The metal of each texel, averaged over it: rays that meet metal then look up a few bytes that lie close together,
/// not four textures far apart, which is what most of their time went to.
class MetalTexels {
 public:
  /// Of the texels whose material is_opaque_metal().
  MetalTexels(const TexelMap& map, const AtlasSpace& space);

  /// The share of rays that should end on the texel's diffuse part, by strength: 0 where there is none, 1 where there
  /// is no metal.
  [[nodiscard]] float ending(std::uint32_t texel) const { return static_cast<float>(texels_[texel].ending) / whole; }
  /// The part of the texel that is metal, 0..1.
  [[nodiscard]] float metallic(std::uint32_t texel) const {
    return static_cast<float>(texels_[texel].metallic) / whole;
  }
  /// That part: metallic 1, with its shading normal.
  /// @param material of the texel.
  [[nodiscard]] SurfaceMaterial metal(std::uint32_t texel, const Material& material) const;

 private:
  static constexpr int whole = 255;
  struct Metal {
    std::int16_t normal_u, normal_v;           // octahedral
    std::uint8_t root_colour[3];               // square roots, 255 for 1
    std::uint8_t roughness, metallic, ending;  // 255 for 1
  };
  [[nodiscard]] static Metal mean_over(const TexelMap& map, const AtlasSpace& space, std::uint32_t texel);

  std::vector<Metal> texels_;  // empty without metals
};

}  // namespace penumbra
