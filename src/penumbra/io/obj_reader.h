#pragma once

#include <filesystem>

#include "penumbra/io/load_report.h"
#include "penumbra/io/read_options.h"

namespace penumbra {

/// Reads Wavefront OBJ with its MTL files. Polygons are kept as faces beside their triangles (ear clipping for concave
/// ones); positions are read in double precision and scaled by `unit`.
/// Each `o` object is a mesh (without any, each `g` group; without any, the file). Colours of positions are linear.
/// MtlMaterials says what becomes of MTL statements; a missing MTL file or picture is a warning.
/// Files that it names are looked for as AssetFolder says.
/// Throws FileError that names the line.
[[nodiscard]] LoadedScene read_obj(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace penumbra
