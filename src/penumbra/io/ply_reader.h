#pragma once

#include <filesystem>

#include "penumbra/io/load_report.h"

namespace penumbra {

/// Reads the Stanford polygon format (G. Turk 1994), ASCII and binary of either byte order: vertices with positions
/// (and colours, normals, texture coordinates where they are whole), faces as lists of any length, kept as polygons
/// beside their triangles. Other elements and properties are passed over.
/// @param unit metres per file unit.
/// Throws FileError that names the line (header, ASCII) or the face or vertex (binary).
[[nodiscard]] LoadedScene read_ply(const std::filesystem::path& path, double unit = 1.0);

}  // namespace penumbra
