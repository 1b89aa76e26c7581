#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "penumbra/baking/atlas_light.h"
#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// How a file carries baked light.
enum class BakeProfile {
  unlit,      ///< the picture of the light itself, cut at 1: every viewer shows it
  hdr,        ///< the same as emission with a strength, so that nothing is cut
  lightmap,   ///< the materials as they were, light apart: for engines that multiply the two
  occlusion,  ///< materials and lights as they were, and how open the surface is
};

/// A scene to be written: objects, triangles, materials and their names are the input's.
struct BakedScene {
  Scene scene;
  std::map<std::string, std::string> notes;  ///< what the numbers mean, for the file's extras
  std::optional<std::uint32_t> lightmap;     ///< of lightmap and occlusion: index into Scene::textures
  float lightmap_strength = 1;               ///< W/m^2 of a texel that is 1
};

/// Dresses the atlas's scene in its light. Lamps, points, suns and the environment are left out: what they do is in the
/// texels. The faces that were lamps still shine.
///
/// - unlit: texels are radiance x 2^exposure, cut at 1, as unlit base colour in TEXCOORD_0, dithered 8-bit sRGB.
/// - hdr: the same, not cut: each material's emission is a texture times the largest radiance among its faces.
/// - lightmap: a texture of irradiance over `lightmap_strength` in TEXCOORD_1; materials and TEXCOORD_0 stay.
/// - occlusion: a linear texture of one channel in TEXCOORD_1; lamps stay too.
/// @param light radiance for unlit and hdr (turn_into_radiance), irradiance for lightmap, openness for occlusion; gaps
/// filled. @param exposure stops (EV); not applied to lightmap and occlusion.
[[nodiscard]] BakedScene baked_scene(LightmapAtlas atlas, AtlasLight light, BakeProfile profile, double exposure);

}  // namespace penumbra
