#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "penumbra/image/image.h"

namespace penumbra {

/// 8-bit texels as a PNG, JPEG or WebP file holds them: 1 to 4 channels interleaved, row 0 at the top,
/// encoding (sRGB or linear) left to whoever knows what they mean.
struct Image8 {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<std::uint8_t> data;
};

/// The largest width or height that is read, pixels: dimensions are checked before anything is allocated.
inline constexpr int max_image_side = 32768;

/// Reads a .png (8 or 16 bit; sRGB decoded to linear), .hdr or .exr picture as linear float.
/// The kind is told by the file's first bytes. A PNG's channels are Y, YA, RGB or RGBA; EXR keeps all its channels
/// (R, G, B, A first, the rest by name) and string metadata. Throws FileError.
[[nodiscard]] Image read_image(const std::filesystem::path& path);

/// Decodes PNG, JPEG or WebP from memory, by its magic bytes. `name` is what errors call it. Throws FileError.
[[nodiscard]] Image8 decode_image8(std::span<const std::byte> bytes, std::string_view name);

/// Encodes 8-bit texels as PNG (1, 2, 3 or 4 channels). @param texts UTF-8 by keyword (1 to 79 letters), carried along.
[[nodiscard]] std::vector<std::byte> encode_png(const Image8& image,
                                                const std::map<std::string, std::string>& texts = {});

/// Writes `.exr` (32-bit float, every channel, metadata), `.hdr` (RGBE, first three channels) or `.png`
/// (8-bit sRGB of the first three channels, clamped to 0..1, alpha if a channel is "A"), by extension. Metadata becomes
/// text in .png and comments in .hdr.
/// Written beside the final name and renamed when whole. Throws FileError for another extension or a file
/// that cannot be created, std::system_error when the device refuses.
void write_image(const std::filesystem::path& path, const Image& image);

}  // namespace penumbra
