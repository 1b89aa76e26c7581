#pragma once

#include "penumbra/scene/scene.h"

namespace penumbra {

/// How the 8-bit red, green and blue of an image are meant; alpha is always linear, and so are float images.
enum class TexelEncoding { linear, srgb };

/// The colour of a texture at (u, v), v downwards, as glTF reads it: wrapped, filtered after decoding, 8-bit values
/// over 255. One channel is grey, two are grey and alpha; missing alpha is 1. White where the image has no texels;
/// coordinates that are not finite count as 0.
[[nodiscard]] Vec4f texture_value(const Texture& texture, const TextureImage& image, const Vec2f& uv,
                                  TexelEncoding encoding);

/// The same for a material's reference to a texture: chooses the UV set and applies the transform.
[[nodiscard]] Vec4f texture_value(const Scene& scene, const TextureRef& ref, const Vec2f (&uv)[2],
                                  TexelEncoding encoding);

/// One texel, decoded, as red, green, blue and alpha. @pre the image has texels, and (x, y) lies in it.
[[nodiscard]] Vec4f texel(const TextureImage& image, int x, int y, TexelEncoding encoding);

/// Whether there are as many values as its sizes say, and any.
[[nodiscard]] bool has_texels(const TextureImage& image);

/// The mean of all texels, decoded first; white where the image has none.
[[nodiscard]] Vec4f mean_texel(const TextureImage& image, TexelEncoding encoding);

/// Linear value, 0..1, of an sRGB-encoded one (IEC 61966-2-1).
[[nodiscard]] float srgb_to_linear(float encoded);

/// Whether a material has any texture, so that texture coordinates matter.
[[nodiscard]] bool reads_textures(const Material& material);

}  // namespace penumbra
