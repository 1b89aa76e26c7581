#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "penumbra/io/asset_folder.h"
#include "penumbra/io/mtl_library.h"
#include "penumbra/io/warning_tally.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// Turns what MTL files say into materials of the scene, loading each picture once. A picture that cannot be read is a
/// warning, and the colour stands alone.
///
/// | MTL | Material |
/// |---|---|
/// | Ks 0 or absent, or illum 0 or 1 | pure Lambert: base_colour = Kd |
/// | Ks > 0 with illum 2 or none | glossy layer: F0 = Ks, GGX alpha = sqrt(2 / (Ns + 2)) (Walter et al. 2007) |
/// | illum 3, 5 | mirror = Ks over Kd |
/// | illum 4, 6, 7, 9, or d < 1 with Ni | glass: ior = Ni (1.5), transmission = 1 - d (1 where d is 1), tint = Tf, else
/// Kd if some light stays diffuse, else white | | d < 1 else | alpha blending | | Ke | emission, radiance |
class MtlMaterials {
 public:
  /// @param folder where pictures are looked for.
  MtlMaterials(AssetFolder folder, Scene& scene, WarningTally& warnings)
      : folder_(std::move(folder)), scene_(scene), warnings_(warnings) {}

  [[nodiscard]] Material material(std::string_view name, const MtlMaterial& mtl);

 private:
  [[nodiscard]] std::optional<TextureRef> texture(const MtlMap& map, const MtlMaterial& mtl);
  [[nodiscard]] std::optional<std::uint32_t> image(const MtlMap& map, const MtlMaterial& mtl);
  void set_textures(Material& material, const MtlMaterial& mtl);
  [[nodiscard]] Rgb reflectance(const Rgb& colour, const MtlMaterial& mtl);

  AssetFolder folder_;
  Scene& scene_;
  WarningTally& warnings_;
  std::map<std::string, std::optional<std::uint32_t>> image_of_file_;
  std::map<std::pair<std::uint32_t, bool>, std::uint32_t> texture_of_image_;  // image, clamped
};

/// What a face without a material is made of: matt, reflectance 0.8.
[[nodiscard]] Material default_obj_material();

}  // namespace penumbra
