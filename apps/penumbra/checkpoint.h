#pragma once

#include <memory>
#include <string>

#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/scene/scene.h"

namespace penumbra::cli {

/// Writes what was expensive to compute: elements, form factors, light by mirrors and glass, what each light brings.
/// Throws FileError, std::system_error. @pre the setup keeps its factors as a matrix.
void write_checkpoint(const std::string& path, const Scene& scene, const RadiositySetup& setup);

/// Reads it back for the same surfaces under the lights and colours that the scene has now; traces no rays. Throws
/// FileError when the scene's geometry, mirrors, glass or places of lights are others, or when a light that was dark
/// then is not now.
[[nodiscard]] std::unique_ptr<RadiositySetup> read_checkpoint(const std::string& path, const Scene& scene,
                                                              const RadiositySetupOptions& options);

}  // namespace penumbra::cli
