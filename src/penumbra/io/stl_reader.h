#pragma once

#include <filesystem>

#include "penumbra/io/load_report.h"

namespace penumbra {

/// Reads stereolithography files, ASCII or binary (told apart by the size that the binary count implies, for many
/// binary files begin with "solid" too). Vertices that are exactly equal become one; stored normals are ignored: the
/// order of corners decides. Each `solid` of an ASCII file is an object.
/// @param unit metres per file unit.
/// Throws FileError that names the line or the facet.
[[nodiscard]] LoadedScene read_stl(const std::filesystem::path& path, double unit = 1.0);

}  // namespace penumbra
