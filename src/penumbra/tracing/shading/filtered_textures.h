#pragma once

#include <array>
#include <optional>
#include <vector>

#include "penumbra/tracing/ray_differential.h"
#include "penumbra/tracing/shading/texture_pyramid.h"

namespace penumbra {

/// The textures of a scene as samples of a picture see them: averaged over what each covers of the surface, instead of
/// read at a point. Pyramids are built once; reading is thread-safe and takes no lock.
class FilteredTextures {
 public:
  /// Builds the pyramids of all images that materials use. The tracer and its scene must outlive this.
  explicit FilteredTextures(const RayTracer& tracer);

  /// Whether there is anything to filter, so that differentials are worth following.
  [[nodiscard]] bool any() const { return any_; }

  /// A surface under a sample's footprint.
  class View {
   public:
    View(const FilteredTextures& textures, const SurfacePoint& point, const Footprint& footprint);

    /// A texture averaged over the footprint.
    [[nodiscard]] Vec4f value(const TextureRef& ref, TexelEncoding encoding) const;
    [[nodiscard]] const Footprint& footprint() const { return *footprint_; }

   private:
    const FilteredTextures* textures_;
    const SurfacePoint* point_;
    const Footprint* footprint_;
    TextureFootprint uv_[2];
  };

 private:
  [[nodiscard]] bool is_filtered(std::uint32_t material) const { return filtered_[material] != 0; }

  const RayTracer* tracer_;
  std::vector<char> filtered_;                                          // by material: it has a texture
  std::vector<std::array<std::optional<TexturePyramid>, 2>> pyramids_;  // by image and encoding
  bool any_ = false;
};

}  // namespace penumbra
