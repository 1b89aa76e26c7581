#pragma once

#include <filesystem>

#include <string>
#include <vector>

#include "penumbra/scene/polygon_model.h"

namespace penumbra {

/// A thermal model and what its reader had to say about it, one full sentence each.
struct LoadedPolygonModel {
  PolygonModel model;
  std::vector<std::string> warnings;
};

/// Reads View3D's geometry files (G. N. Walton, NISTIR 6925, 2002; View3D user manual 3.3), formats `F 3` (vertices and
/// surfaces) and `F 3a` (each surface in a plane of its own).
///
/// The model holds a polygon for each surface line S, M, N or O, in file order, with its line as its place. Control
/// values
/// (`C`) steer View3D's own integration and are passed over; what would change the result (`emit`, `row`, `col`) gives
/// a warning.
/// @param unit metres per file unit.
/// Throws FileError that names the line: an unknown keyword, a number missing or out of range, a surface or vertex that
/// is named but not there, or a file without its last line (`E`, end of data).
[[nodiscard]] LoadedPolygonModel read_vs3(const std::filesystem::path& path, double unit = 1.0);

}  // namespace penumbra
