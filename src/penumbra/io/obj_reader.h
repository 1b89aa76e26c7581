#pragma once

#include <filesystem>

#include "penumbra/io/load_report.h"

namespace penumbra {

/// Reads Wavefront OBJ with its MTL files. Polygons are kept as faces beside their triangles (ear clipping for concave
/// ones); positions are read in double precision and scaled by `unit`.
/// @param unit metres per file unit.
/// Throws FileError that names the line.
[[nodiscard]] LoadedScene read_obj(const std::filesystem::path& path, double unit = 1.0);

}  // namespace penumbra
