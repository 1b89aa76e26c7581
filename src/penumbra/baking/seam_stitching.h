#pragma once

#include <cstdint>
#include <span>

#include "penumbra/baking/chart_map.h"
#include "penumbra/baking/chart_seams.h"

namespace penumbra {

/// Changes the texels at seams, as little as may be, so that bilinear lookups on both sides agree: least squares over
/// points along the seams (after Iwanicki, "Lighting technology of The Last of Us", 2013), by conjugate gradients.
/// Where both sides have their texels alike along the seam the two agree to rounding, else as well as texels can.
/// Texels that a chart covers resist more than those beside it. No value falls below `lowest`.
/// @param values [pixel * channels + channel], known at every chart and one ring around it.
/// @param covered by pixel: 1 where a chart has its light from the scene.
void stitch_seams(std::span<const ChartSeam> seams, int width, int height, std::span<const std::uint8_t> covered,
                  std::span<float> values, std::size_t channels, float lowest = 0);

}  // namespace penumbra
