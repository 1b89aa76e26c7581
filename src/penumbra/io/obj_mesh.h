#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "penumbra/io/obj_model.h"
#include "penumbra/io/warning_tally.h"
#include "penumbra/scene/mesh.h"

namespace penumbra {

/// One mesh for each part of the model that has faces, in file order: corners with the same position, texture
/// coordinate and normal share a vertex; polygons are kept as faces beside their triangles. Polygons non-planar by more
/// than 1e-6 of their size, and outlines that touch themselves, become faces of three corners, with one counted
/// warning.
/// @param path what errors call the file.
/// Materials are indices into `model.material_names`. Throws FileError for an outline that crosses itself.
[[nodiscard]] std::vector<Mesh> make_obj_meshes(const ObjModel& model, const std::string& path, WarningTally& warnings);

}  // namespace penumbra
