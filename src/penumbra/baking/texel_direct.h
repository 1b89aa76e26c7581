#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/baking/straight_light.h"
#include "penumbra/parallel/progress.h"

namespace penumbra {

/// Straight light of the front of every texel, [texel * 3 + band], W/m^2: at its sample point, or the mean over its
/// free part where light bends between it and its neighbours. Black where stopped early.
[[nodiscard]] std::vector<float> direct_light_of_texels(const StraightLight& straight, const SamplePoints& points,
                                                        const AtlasSpace& space, const TexelMap& map,
                                                        std::span<const std::uint32_t> order, const Progress& progress);

}  // namespace penumbra
