#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/baking/texels.h"
#include "penumbra/parallel/progress.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// Irradiance of texels, of the front of their faces. Arrays are per texel.
struct TexelLight {
  std::vector<float> irradiance;     ///< [texel * 3 + band], W/m^2, from everywhere
  std::vector<float> direct;         ///< the part of it that comes straight from lamps, points, spots, far lights
  std::vector<float> error;          ///< estimated standard error of the luminance, relative to the scene's mean
  std::vector<std::uint8_t> buried;  ///< 1 where the texel lies inside solid matter: its light is another's, or none
  bool partial = false;
};

}  // namespace penumbra
