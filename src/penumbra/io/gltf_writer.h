#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// Writes a .glb that gltf-validator passes without error. Exact primitives are tessellated, infinite planes cut to a
/// square; what glTF cannot say goes to `extras.penumbra`. Written beside the final name and renamed when whole.
/// Returns warnings (what was approximated), one sentence each. @param notes go to the scene's
/// `extras.penumbra.baked`. Throws FileError, std::system_error.
std::vector<std::string> write_glb(const std::filesystem::path& path, const Scene& scene,
                                   const std::map<std::string, std::string>& notes = {});

}  // namespace penumbra
