#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A radiosity solution as plain columns: a row for each radiating side of an element.
///
/// On disk: `cx cy cz` (m) the centre, `nx ny nz` the unit normal, `area` (m^2), `reflectance_{r,g,b}`,
/// `emission_{r,g,b}`, `irradiance_{r,g,b}` and `radiosity_{r,g,b}` (W/m^2), `surface` (the input polygon's number from
/// 0), `object` (its name) and `side` ("front" or "back").
struct ElementTable {
  std::vector<Vec3d> centres, normals;
  std::vector<double> areas;
  std::vector<double> reflectance, emission, irradiance, radiosity;  ///< [row * 3 + band]
  std::vector<std::int64_t> surfaces;
  std::vector<std::string> objects;
  std::vector<bool> backs;
  /// Of the irradiance, what comes straight from lights by way of mirrors and glass; in .npz alone, may be missing.
  std::vector<double> caustics;
  bool partial = false;                   ///< the computation was stopped
  std::vector<std::string> fingerprints;  ///< what identifies the scene; in .npz alone, may be missing

  /// Of a solution over bands of wavelength, in .npz alone: edges in nm, one more than bands, as `wavelength_edges`,
  /// and [row][band] W/m^2 as `spectral_radiosity`. Else empty.
  std::vector<double> wavelength_edges, spectral_radiosity;

  // The elements' polygons; in .npz alone, as `vertices`, `corner_offsets` and `corners`.
  std::vector<Vec3d> vertices;               ///< m
  std::vector<std::int64_t> corner_offsets;  ///< row k has the corners [offsets[k], offsets[k + 1])
  std::vector<std::int64_t> corners;         ///< into vertices

  [[nodiscard]] std::size_t rows() const { return areas.size(); }
};

/// Writes .npz (NumPy, nothing pickled) or .csv, by the extension; beside the final name and renamed when whole. Throws
/// FileError, std::system_error.
void write_element_table(const std::filesystem::path& path, const ElementTable& table);

/// Reads an .npz that was written so. Throws FileError that names the array when one is missing, of another length, or
/// points outside.
[[nodiscard]] ElementTable read_element_table(const std::filesystem::path& path);

}  // namespace penumbra
