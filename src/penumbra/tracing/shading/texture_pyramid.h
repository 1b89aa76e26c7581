#pragma once

#include <vector>

#include "penumbra/scene/texture_lookup.h"

namespace penumbra {

/// What a sample of the picture covers of a texture, to first order: how (u, v) changes from the sample to its
/// neighbour on the right (x) and below (y).
struct TextureFootprint {
  Vec2d x{0}, y{0};
};

/// An image at half the size, a quarter, and so on to one texel (Williams, "Pyramidal Parametrics", SIGGRAPH 1983),
/// linear values: means over areas of any size at the price of a few texels. Immutable, so read without locks.
class TexturePyramid {
 public:
  /// Sizes halve rounded down; each texel is the exact mean of the area that it covers of the level below.
  /// The image must outlive the pyramid. @pre it has texels.
  TexturePyramid(const TextureImage& image, TexelEncoding encoding);

  /// The texture averaged over a footprint around `uv`: trilinear probes, as wide as the footprint's short axis, spread
  /// evenly over its long one (McCormack, Perry, Farkas & Jouppi, "Feline", SIGGRAPH 1999). Their spread is the
  /// footprint's own, as second moments go; of a footprint more than 16 times as long as wide the short axis is taken
  /// for wider. Below the size of texels it is what `texture_value` gives, also for textures without mipmaps.
  [[nodiscard]] Vec4f value(const Texture& texture, const Vec2d& uv, const TextureFootprint& footprint) const;

  /// The number of levels below the image itself.
  [[nodiscard]] int level_count() const { return static_cast<int>(levels_.size()); }
  /// Texels of a level, row by row from the top. @param level 1 to level_count().
  [[nodiscard]] const std::vector<Vec4f>& texels(int level) const {
    return levels_[static_cast<std::size_t>(level - 1)].texels;
  }

 private:
  struct Level {
    int width = 0;
    int height = 0;
    std::vector<Vec4f> texels;
  };
  [[nodiscard]] Vec4f bilinear(int level, const Texture& texture, const Vec2d& uv) const;
  [[nodiscard]] Vec4f trilinear(double width, const Texture& texture, const Vec2d& uv) const;

  const TextureImage* image_;
  TexelEncoding encoding_;
  std::vector<Level> levels_;
};

}  // namespace penumbra
