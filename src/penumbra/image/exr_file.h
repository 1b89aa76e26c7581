#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "penumbra/image/image.h"

namespace penumbra {

/// Decodes an OpenEXR file of scan lines or tiles: every channel as float, R, G, B, A first if they are there and the
/// rest by name; string attributes as metadata. Of a multi-part file, the first part. Throws FileError.
[[nodiscard]] Image decode_exr(std::span<const std::byte> bytes, std::string_view name);

enum class ExrDepth {
  full,  ///< 32-bit float
  half,  ///< 16-bit float: 11 bits of precision, up to 65504, where larger values are cut
};

/// Encodes every channel, ZIP compressed, metadata as string attributes.
/// Throws std::invalid_argument when a metadata key is empty or one that OpenEXR needs itself, or channels repeat.
[[nodiscard]] std::vector<std::byte> encode_exr(const Image& image, ExrDepth depth = ExrDepth::full);

}  // namespace penumbra
