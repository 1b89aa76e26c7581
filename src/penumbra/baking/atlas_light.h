#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "penumbra/baking/chart_map.h"
#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/baking/texels.h"
#include "penumbra/image/image.h"

namespace penumbra {

struct AtlasLightOptions {
  bool stitch = true;          ///< make both sides of seams agree
  double crease_angle = 0.35;  ///< rad; edges that turn by more are no seams
  std::vector<std::string> channels{"R", "G", "B"};
  float lowest = 0;                        ///< stitching leaves no value below
  std::span<const std::uint8_t> buried{};  ///< 1: texels without a value, which take their chart's nearest
};

/// Light over a whole atlas, for bilinear lookups.
struct AtlasLight {
  Image image;                        ///< linear; R, G, B, and A where some material lets see through; or as asked
  ChartMap map;                       ///< whose each pixel is; known at every chart and one texel around it
  std::vector<std::uint8_t> covered;  ///< by pixel: 1 where a chart lies
};

/// Values of the texels as a picture, one texel spread around each chart, seams stitched.
/// @param values [texel * channels + channel], such as irradiance, W/m^2.
[[nodiscard]] AtlasLight make_atlas_light(const LightmapAtlas& atlas, const Texels& texels,
                                          std::span<const float> values, const AtlasLightOptions& options = {});

/// Irradiance to the radiance that leaves the fronts, W/(m^2 sr): emission + diffuse reflectance x irradiance / pi, the
/// materials averaged over each texel, texels beside a chart with its own. Alpha is added when a material has it.
/// Unlit materials of the scene shine with their base colour.
void turn_into_radiance(AtlasLight& light, const LightmapAtlas& atlas, const Texels& texels);

/// Spreads what is known over the rest of the atlas.
void fill_gaps(AtlasLight& light);

}  // namespace penumbra
