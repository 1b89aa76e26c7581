#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace penumbra {

/// The largest number of pixels that is read.
inline constexpr std::int64_t max_image_pixels = std::int64_t{1} << 28;

/// Refuses a picture before anything is allocated for it: an empty one, a side beyond `max_image_side`, more than
/// `max_image_pixels`, or far more samples than `file_bytes` bytes could hold (a decompression bomb).
/// @param name what the error calls the file. Throws FileError.
void check_decode_limits(std::int64_t width, std::int64_t height, std::int64_t channels, std::size_t file_bytes,
                         std::string_view name);

}  // namespace penumbra
