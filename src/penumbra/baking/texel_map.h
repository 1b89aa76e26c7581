#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/baking/texels.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Finds texels: by the point of a triangle that a ray meets, and by their place in the atlas.
class TexelMap {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  /// Both must outlive this.
  TexelMap(const LightmapAtlas& atlas, const Texels& texels);

  /// The texel at weights (u, v) of vertices 1 and 2 of a triangle; where rounding leads beyond the covered texels,
  /// one beside. `none` where there is none: the faces without a place in the atlas.
  [[nodiscard]] std::uint32_t at(std::uint32_t triangle, float u, float v) const {
    const Unfolding& f = unfoldings_[triangle];
    const auto x = static_cast<int>(f.x + u * f.x1 + v * f.x2), y = static_cast<int>(f.y + u * f.y1 + v * f.y2);
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return none;
    return texel_at_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }

  /// The texel beside another, in texels to the right and down; `none` outside its chart.
  [[nodiscard]] std::uint32_t beside(std::uint32_t texel, int right, int down) const;
  [[nodiscard]] std::uint32_t chart(std::uint32_t texel) const {
    return atlas_.chart_of_triangle[texels_.triangles[texel]];
  }
  /// Where a corner of a triangle lies in the atlas, texels.
  [[nodiscard]] Vec2d corner(std::uint32_t triangle, int corner) const;
  /// Along the surface from one texel to the next, to the right and down, m. Zero for a triangle without area.
  struct Steps {
    Vec3d right{0}, down{0};
  };
  [[nodiscard]] Steps steps(std::uint32_t triangle) const;

  [[nodiscard]] const LightmapAtlas& atlas() const { return atlas_; }
  [[nodiscard]] const Texels& texels() const { return texels_; }
  /// The instance that holds a triangle.
  [[nodiscard]] std::uint32_t instance(std::uint32_t triangle) const;
  [[nodiscard]] std::uint32_t material(std::uint32_t triangle) const;

 private:
  struct Unfolding {
    float x, y, x1, y1, x2, y2;  // texels: vertex 0, and from it to vertices 1 and 2
  };
  const LightmapAtlas& atlas_;
  const Texels& texels_;
  int width_, height_;
  std::vector<Unfolding> unfoldings_;    // by triangle
  std::vector<std::uint32_t> texel_at_;  // by pixel
};

/// Texels in an order in which neighbours are close: chart by chart, along a Morton curve in each.
[[nodiscard]] std::vector<std::uint32_t> texels_in_blocks(const TexelMap& map);

}  // namespace penumbra
