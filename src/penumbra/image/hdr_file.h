#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "penumbra/image/image.h"

namespace penumbra {

/// Decodes a Radiance picture (RGBE; flat or run-length coded, new style) to channels R, G, B; EXPOSURE lines are
/// divided out, so values are radiances. Throws FileError.
[[nodiscard]] Image decode_hdr(std::span<const std::byte> bytes, std::string_view name);

/// Encodes the first three channels (or one grey channel) as a Radiance picture: RGBE (Ward 1991, "Real pixels",
/// Graphics Gems II), run-length coded. Mantissas are rounded to nearest, for readers that take them as they are
/// (stb, three.js, OpenImageIO); an error of at most 1/256 of a pixel's largest component.
/// NaN and negative values become 0, values beyond 1.7e38 the largest that RGBE holds.
[[nodiscard]] std::vector<std::byte> encode_hdr(const Image& image);

}  // namespace penumbra
