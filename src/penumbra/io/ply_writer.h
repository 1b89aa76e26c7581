#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "penumbra/io/vtk_writer.h"

namespace penumbra {

/// Writes polygons in the Stanford polygon format (G. Turk 1994), binary little-endian: positions in double precision,
/// a double property for each array of values, named as it is with blanks made underscores.
/// @param colours sRGB, three bytes a polygon, for viewers; may be empty. @param comment one line of the head; may be
/// empty.
/// Written beside the final name and renamed when whole. Throws FileError, std::system_error. @pre every array of
/// values is as long as `offsets`.
void write_ply(const std::filesystem::path& path, const PolygonCells& cells, const std::vector<std::uint8_t>& colours,
               const std::string& comment = "");

}  // namespace penumbra
