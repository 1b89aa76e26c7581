#include "penumbra/image/webp_decode.h"

#include <webp/decode.h>

#include "penumbra/file/file_error.h"
#include "penumbra/image/decode_limits.h"

namespace penumbra {

Image8 decode_webp(std::span<const std::byte> bytes, std::string_view name) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK) {
    throw FileError(name, "", "cannot be decoded, its WebP header is damaged or cut short");
  }
  if (features.has_animation != 0) throw FileError(name, "", "is an animated WebP; save one of its frames as a still");

  Image8 image;
  image.width = features.width;
  image.height = features.height;
  image.channels = features.has_alpha != 0 ? 4 : 3;
  check_decode_limits(image.width, image.height, image.channels, bytes.size(), name);
  const int stride = image.width * image.channels;
  image.data.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(image.height));
  auto* decode = image.channels == 4 ? &WebPDecodeRGBAInto : &WebPDecodeRGBInto;
  if (decode(data, bytes.size(), image.data.data(), image.data.size(), stride) == nullptr) {
    throw FileError(name, "", "cannot be decoded, its WebP data is damaged or cut short");
  }
  return image;
}

}  // namespace penumbra
