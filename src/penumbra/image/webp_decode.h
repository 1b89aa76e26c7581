#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "penumbra/image/image_io.h"

namespace penumbra {

/// Decodes a WebP file: 4 channels when it has transparency, else 3. Throws FileError, for animations too.
[[nodiscard]] Image8 decode_webp(std::span<const std::byte> bytes, std::string_view name);

}  // namespace penumbra
