#include "penumbra/scene/texture_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/scene/texel_address.h"

namespace penumbra {
namespace {

/// Linear values of the 256 codes; computed once.
const std::array<float, 256>& decoded_codes(TexelEncoding encoding) {
  const auto tabulate = [](auto&& decode) {
    std::array<float, 256> values{};
    for (int code = 0; code < 256; ++code) values[code] = decode(static_cast<float>(code) / 255.0F);
    return values;
  };
  static const std::array<float, 256> linear = tabulate([](float x) { return x; });
  static const std::array<float, 256> srgb = tabulate([](float x) { return srgb_to_linear(x); });
  return encoding == TexelEncoding::srgb ? srgb : linear;
}

/// 1, 2, 3 or 4 channels as red, green, blue, alpha.
Vec4f spread_channels(const std::array<float, 4>& c, int channels) {
  if (channels <= 2) return {c[0], c[0], c[0], channels == 2 ? c[1] : 1.0F};
  return {c[0], c[1], c[2], channels == 4 ? c[3] : 1.0F};
}

}  // namespace

Vec4f texel(const TextureImage& image, int x, int y, TexelEncoding encoding) {
  const int channels = std::min(image.channels, 4);
  const std::size_t start = (static_cast<std::size_t>(y) * image.width + x) * image.channels;
  const int alpha = channels == 2 || channels == 4 ? channels - 1 : channels;  // the channel that is never encoded
  std::array<float, 4> c{};
  if (const auto* bytes = std::get_if<std::vector<std::uint8_t>>(&image.texels)) {
    const std::array<float, 256>& decode = decoded_codes(encoding);
    for (int i = 0; i < alpha; ++i) c[i] = decode[(*bytes)[start + i]];
    if (alpha < channels) c[alpha] = static_cast<float>((*bytes)[start + alpha]) / 255.0F;
  } else {
    const auto& floats = std::get<std::vector<float>>(image.texels);
    for (int i = 0; i < channels; ++i) c[i] = floats[start + i];
  }
  return spread_channels(c, channels);
}

bool has_texels(const TextureImage& image) {
  if (image.width <= 0 || image.height <= 0 || image.channels <= 0) return false;
  const std::size_t needed = static_cast<std::size_t>(image.width) * image.height * image.channels;
  return std::visit([&](const auto& texels) { return texels.size() >= needed; }, image.texels);
}

namespace {

int nearest(double coordinate, int size) { return std::clamp(static_cast<int>(coordinate * size), 0, size - 1); }

Vec4f between(const Vec4f& a, const Vec4f& b, float share) { return a * (1 - share) + b * share; }

}  // namespace

float srgb_to_linear(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

Vec4f texture_value(const Texture& texture, const TextureImage& image, const Vec2f& uv, TexelEncoding encoding) {
  if (!has_texels(image)) return Vec4f(1.0F);
  const double u = wrapped(static_cast<double>(uv.x), texture.wrap_u);
  const double v = wrapped(static_cast<double>(uv.y), texture.wrap_v);
  if (texture.filter == TexelFilter::nearest)
    return texel(image, nearest(u, image.width), nearest(v, image.height), encoding);
  const TexelPair x = texels_around(u, image.width, texture.wrap_u);
  const TexelPair y = texels_around(v, image.height, texture.wrap_v);
  const auto row = [&](int j) {
    return between(texel(image, x.first, j, encoding), texel(image, x.second, j, encoding), x.share);
  };
  return between(row(y.first), row(y.second), y.share);
}

Vec4f texture_value(const Scene& scene, const TextureRef& ref, const Vec2f (&uv)[2], TexelEncoding encoding) {
  const Texture& texture = scene.textures[ref.texture];
  const Vec3f transformed = ref.transform * Vec3f(uv[ref.uv_set == 1 ? 1 : 0], 1.0F);
  return texture_value(texture, scene.images[texture.image], Vec2f(transformed), encoding);
}

Vec4f mean_texel(const TextureImage& image, TexelEncoding encoding) {
  if (!has_texels(image)) return Vec4f(1.0F);
  Vec4d sum(0);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) sum += Vec4d(texel(image, x, y, encoding));
  }
  return Vec4f(sum / (static_cast<double>(image.width) * image.height));
}

bool reads_textures(const Material& m) {
  return m.base_colour_texture || m.metallic_roughness_texture || m.normal_texture || m.emission_texture ||
         m.transmission_texture || m.specular_texture || m.specular_colour_texture;
}

}  // namespace penumbra
