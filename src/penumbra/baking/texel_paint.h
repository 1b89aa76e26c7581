#pragma once

#include <cstdint>

#include "penumbra/baking/atlas_space.h"
#include "penumbra/baking/texel_rays.h"
#include "penumbra/math/spectrum.h"

namespace penumbra {

/// What a texel's piece of surface does on average.
struct TexelPaint {
  Rgb albedo{0.0F};         ///< diffuse reflectance of either side, 0..1
  Rgb emission{0.0F};       ///< radiosity of the front, W/m^2, but for what counts as straight light
  Rgb back_emission{0.0F};  ///< the same of the back
  float matt = 0;           ///< the share that passes no light on: neither metal, mirror, glass nor see-through, 0..1
};

/// Materials, textures and vertex colours averaged over a texel. Thread-safe.
[[nodiscard]] TexelPaint paint_of_texel(const TexelMap& map, const AtlasSpace& space, const StraightLamps& lamps,
                                        std::uint32_t texel);

}  // namespace penumbra
