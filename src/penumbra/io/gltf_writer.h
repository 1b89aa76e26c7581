#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// Light that was baked into a texture of the scene, for viewers that know MOZ_lightmap; others pass over it.
struct GltfLightmap {
  std::uint32_t texture = 0;  ///< index into Scene::textures: irradiance / strength, sRGB-encoded
  std::uint32_t uv_set = 1;
  float strength = 1;  ///< W/m^2
};

/// Writes a .glb that gltf-validator passes without error. Exact primitives are tessellated, infinite planes cut to a
/// square; what glTF cannot say goes to `extras.penumbra`, beside the extras of the input. Written beside the final
/// name and renamed when whole. Returns warnings (what was approximated), one sentence each. @param notes go to the
/// scene's `extras.penumbra.baked`. @param lightmap is named by every material. Throws FileError, std::system_error.
std::vector<std::string> write_glb(const std::filesystem::path& path, const Scene& scene,
                                   const std::map<std::string, std::string>& notes = {},
                                   const std::optional<GltfLightmap>& lightmap = std::nullopt);

}  // namespace penumbra
