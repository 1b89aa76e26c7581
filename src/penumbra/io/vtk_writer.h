#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A number for each polygon, with the name it has in the viewer.
struct CellValues {
  std::string name;
  std::vector<double> values;
};

/// Polygons with values, as visualisation programs see them. Lengths in metres.
struct PolygonCells {
  std::vector<Vec3d> points;
  std::vector<std::uint64_t> offsets;  ///< polygon k has the corners up to offsets[k] that polygon k - 1 has not
  std::vector<std::uint32_t> corners;  ///< into points
  std::vector<CellValues> values;
};

/// Writes a VTK unstructured grid (.vtu, XML with plain numbers) that ParaView opens. Written beside the final name and
/// renamed when whole. Throws FileError, std::system_error. @pre every array of values is as long as `offsets`.
void write_vtu(const std::filesystem::path& path, const PolygonCells& cells);

}  // namespace penumbra
