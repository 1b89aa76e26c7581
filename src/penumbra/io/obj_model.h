#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "penumbra/io/warning_tally.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// A corner of a face of an OBJ file: indices from 0, or `none`.
struct ObjCorner {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t position = none;
  std::uint32_t uv = none;
  std::uint32_t normal = none;
};

/// A polygon of an OBJ file.
struct ObjFace {
  std::uint32_t first_corner = 0;  ///< into ObjModel::corners
  std::uint32_t corner_count = 0;  ///< 3 or more
  std::uint32_t part = 0;          ///< into ObjModel::parts
  std::uint32_t material = 0;      ///< into ObjModel::material_names
  std::uint32_t line = 0;          ///< where it stood in the file, from 1
};

/// What an OBJ file says, as it says it: metres, file order, every index checked.
struct ObjModel {
  /// A name among several in the file and where it stood.
  struct Library {
    std::string names;  ///< all that followed `mtllib`
    std::string place;
  };

  std::vector<Vec3d> positions;
  std::vector<Vec3f> colours;  ///< linear, as long as `positions` or empty when no position has one
  std::vector<Vec2f> uvs;      ///< v upwards
  std::vector<Vec3f> normals;  ///< of any length
  std::vector<ObjCorner> corners;
  std::vector<ObjFace> faces;
  /// Each becomes a mesh: the `o` objects; without any, the `g` groups by name; without any, the whole file.
  std::vector<std::string> parts;
  std::vector<std::string> material_names;  ///< as `usemtl` calls them, in order of first use; "" where none was chosen
  std::vector<Library> libraries;
};

/// Takes the text of an OBJ file apart.
/// @param path what messages call it; its stem names the part of faces outside any object or group.
/// @param unit metres per file unit.
/// Throws FileError that names the line, and when there are no faces.
[[nodiscard]] ObjModel parse_obj(const std::string& path, std::string_view text, double unit, WarningTally& warnings);

}  // namespace penumbra
