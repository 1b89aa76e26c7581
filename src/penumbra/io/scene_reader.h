#pragma once

#include <string_view>

#include "penumbra/io/load_report.h"

namespace penumbra {

/// Makes or reads any SCENE of the command line: `builtin:NAME?key=value`, or a path by its extension
/// (.glb, .gltf, .obj). @param unit metres per file unit, for formats without one of their own.
/// Throws FileError, or std::invalid_argument for a wrong builtin.
[[nodiscard]] LoadedScene read_scene(std::string_view source, double unit = 1.0);

}  // namespace penumbra
