#include "penumbra/image/image_io.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/file/output_file.h"
#include "penumbra/image/exr_file.h"
#include "penumbra/image/hdr_file.h"
#include "penumbra/image/stb_decode.h"
#include "penumbra/image/tonemap.h"
#include "penumbra/image/webp_decode.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

bool holds(std::span<const std::byte> bytes, std::size_t at, std::string_view magic) {
  return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
}

bool is_png(std::span<const std::byte> bytes) { return holds(bytes, 0, "\x89PNG\r\n\x1a\n"); }
bool is_jpeg(std::span<const std::byte> bytes) { return holds(bytes, 0, "\xff\xd8\xff"); }
bool is_webp(std::span<const std::byte> bytes) { return holds(bytes, 0, "RIFF") && holds(bytes, 8, "WEBP"); }
bool is_exr(std::span<const std::byte> bytes) { return holds(bytes, 0, "\x76\x2f\x31\x01"); }
bool is_hdr(std::span<const std::byte> bytes) { return holds(bytes, 0, "#?RADIANCE") || holds(bytes, 0, "#?RGBE"); }

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::uint8_t linear_to_8_bits(float value) {
  if (!(value > 0)) return 0;  // NaN too
  return static_cast<std::uint8_t>(std::lround(std::min(value, 1.0F) * 255.0F));
}

// The picture as a PNG shows it: colour or grey, and alpha when a channel is called so.
Image8 displayed(const Image& image) {
  const std::size_t stride = image.channels.size();
  const std::size_t colours = stride >= 3 ? 3 : 1;
  const auto alpha = static_cast<std::size_t>(std::ranges::find(image.channels, "A") - image.channels.begin());
  const bool has_alpha = alpha < stride && alpha >= colours;
  const std::size_t shown = colours + (has_alpha ? 1 : 0);
  Image8 out{image.width, image.height, static_cast<int>(shown), {}};
  const std::size_t pixels = image.data.size() / stride;
  out.data.resize(pixels * shown);
  parallel_for(pixels, 1 << 15, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const float* from = image.data.data() + p * stride;
      std::uint8_t* to = out.data.data() + p * shown;
      for (std::size_t c = 0; c < colours; ++c) to[c] = srgb_encode8(from[c]);
      if (has_alpha) to[colours] = linear_to_8_bits(from[alpha]);
    }
  });
  return out;
}

std::vector<std::byte> encoded(const std::filesystem::path& path, const Image& image) {
  const std::string extension = lower_case_extension(path);
  if (extension == ".png") return encode_png(displayed(image), image.metadata);
  if (extension == ".exr") return encode_exr(image);
  if (extension == ".hdr") return encode_hdr(image);
  throw FileError(path.string(), "",
                  extension.empty() ? "has no extension to tell the format by; end its name in .png, .exr or .hdr"
                                    : "cannot be written as " + extension + "; use .png, .exr or .hdr");
}

}  // namespace

Image read_image(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  const std::string name = path.string();
  if (is_png(bytes)) return decode_png_to_linear(bytes, name);
  if (is_hdr(bytes)) return decode_hdr(bytes, name);
  if (is_exr(bytes)) return decode_exr(bytes, name);
  throw FileError(name, "", "is not a PNG, HDR or EXR picture; convert it to one of them");
}

Image8 decode_image8(std::span<const std::byte> bytes, std::string_view name) {
  if (is_png(bytes) || is_jpeg(bytes)) return decode_png_or_jpeg(bytes, name);
  if (is_webp(bytes)) return decode_webp(bytes, name);
  throw FileError(name, "", "is not a PNG, JPEG or WebP picture; convert it to one of them");
}

void write_image(const std::filesystem::path& path, const Image& image) {
  if (image.width < 1 || image.height < 1 || image.channels.empty() ||
      image.data.size() != image.index(0, image.height)) {
    throw std::invalid_argument("a picture to write needs pixels, channels and a value for each of them");
  }
  const auto bytes = encoded(path, image);
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace penumbra
