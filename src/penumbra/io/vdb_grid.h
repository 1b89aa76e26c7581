#pragma once

#include <filesystem>

#include "penumbra/scene/medium.h"

namespace penumbra {

/// The float grid `density` of an OpenVDB file, else its first float grid, sampled trilinearly at the centres of cells
/// of its own voxel size, in world coordinates. Throws FileError; where the program was built without OpenVDB always,
/// with a sentence that says so.
[[nodiscard]] DensityGrid read_vdb_grid(const std::filesystem::path& path);

}  // namespace penumbra
