#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "penumbra/image/image.h"
#include "penumbra/image/image_io.h"

namespace penumbra {

/// Decodes a PNG or JPEG file to 8 bits a sample; deeper ones are cut down. Throws FileError.
[[nodiscard]] Image8 decode_png_or_jpeg(std::span<const std::byte> bytes, std::string_view name);

/// Decodes a PNG file of 8 or 16 bits from sRGB to linear (alpha stays): channels Y, YA, RGB or RGBA. Throws FileError.
[[nodiscard]] Image decode_png_to_linear(std::span<const std::byte> bytes, std::string_view name);

}  // namespace penumbra
