#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/image/image.h"

namespace penumbra {

/// 8-bit sRGB codes of a linear picture, R, G, B interleaved, and A, linear, when there is a fourth channel.
///
/// Between two codes an ordered 8 x 8 pattern (Bayer 1973) chooses, so that the mean of the decoded texels of a smooth
/// area is its light, without bands. Values that a code holds exactly get that code everywhere; below 0 is 0, above 1
/// is
/// 1. @param scale multiplies the light first.
[[nodiscard]] std::vector<std::uint8_t> dithered_srgb8(const Image& image, float scale = 1);

}  // namespace penumbra
