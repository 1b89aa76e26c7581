#include "penumbra/image/decode_limits.h"

#include <fmt/format.h>

#include "penumbra/file/file_error.h"
#include "penumbra/image/image_io.h"

namespace penumbra {

void check_decode_limits(std::int64_t width, std::int64_t height, std::int64_t channels, std::size_t file_bytes,
                         std::string_view name) {
  if (width < 1 || height < 1 || channels < 1) throw FileError(name, "", "is a picture without pixels");
  if (width > max_image_side || height > max_image_side) {
    throw FileError(name, "",
                    fmt::format("is {} x {} pixels, more than the {} a side that are read; scale it down", width,
                                height, max_image_side));
  }
  if (width * height > max_image_pixels) {
    throw FileError(name, "",
                    fmt::format("is {} x {} pixels, more than the {} in all that are read; scale it down", width,
                                height, max_image_pixels));
  }
  // Deflate shrinks by 1032 at most, and the other codecs little more on real pictures. Small pictures may be plain
  // black and shrink to anything, so only large ones are judged.
  constexpr std::int64_t harmless_samples = std::int64_t{1} << 26;
  constexpr std::int64_t samples_per_byte = 5000;
  const std::int64_t samples = width * height * channels;
  if (samples > harmless_samples && samples / samples_per_byte > static_cast<std::int64_t>(file_bytes)) {
    throw FileError(name, "",
                    fmt::format("says it holds {} x {} pixels of {} channels, too many for its {} bytes: it is damaged",
                                width, height, channels, file_bytes));
  }
}

}  // namespace penumbra
