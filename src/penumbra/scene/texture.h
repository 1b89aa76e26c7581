#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// Texels of a texture, row 0 at the top, 1 to 4 channels interleaved; 8-bit, or float for HDR.
struct TextureImage {
  std::string name;
  int width = 0;
  int height = 0;
  int channels = 0;
  std::variant<std::vector<std::uint8_t>, std::vector<float>> texels;
};

enum class Wrap { repeat, clamp, mirror };
enum class TexelFilter { nearest, linear };

/// A way to read an image: glTF's texture and sampler in one.
struct Texture {
  std::uint32_t image = 0;  ///< index into Scene::images
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  TexelFilter filter = TexelFilter::linear;
  /// Whether viewers may blend in coarser copies of the picture. An atlas says no: seen at a grazing angle they would
  /// mix neighbouring charts, however far these stand apart.
  bool mipmaps = true;
};

/// A material's use of a texture: which UV set, and the transform of KHR_texture_transform
/// (uv' = offset + R(rotation) * (scale * uv)) as a matrix on (u, v, 1). v grows downwards, as in glTF.
struct TextureRef {
  std::uint32_t texture = 0;  ///< index into Scene::textures
  std::uint32_t uv_set = 0;   ///< 0 or 1
  Mat3f transform{1.0F};
};

}  // namespace penumbra
