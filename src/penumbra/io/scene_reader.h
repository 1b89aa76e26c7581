#pragma once

#include <string_view>

#include "penumbra/io/load_report.h"
#include "penumbra/io/read_options.h"

namespace penumbra {

/// Makes or reads any SCENE of the command line: `builtin:NAME?key=value`, or a path by its extension
/// (.glb, .gltf, .obj). Only glTF has scenes to choose among and animations; the others take no notice of them.
/// Throws FileError, or std::invalid_argument for a wrong builtin.
[[nodiscard]] LoadedScene read_scene(std::string_view source, const ReadOptions& options = {});

}  // namespace penumbra
