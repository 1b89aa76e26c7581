#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// What a polygon does in an exchange of radiation.
enum class PolygonRole {
  radiates,   ///< has a row of view factors and hides what lies behind it
  obstructs,  ///< hides only (View3D's `O` lines)
  masks,      ///< takes no part itself; as a subsurface it is a hole in its base (View3D's null surfaces, `N`)
  covers,     ///< lies on its base face to face: the two see only each other there (View3D's masking surfaces, `M`)
};

/// One polygon of a thermal model: a line of a .vs3 file.
struct ModelPolygon {
  std::vector<std::uint32_t>
      corners;  ///< into PolygonModel::vertices; counter-clockwise seen from the side that radiates
  std::string name;
  std::string place;  ///< where it stood in its file ("line 30"), for messages; may be empty
  PolygonRole role = PolygonRole::radiates;
  /// Index of the polygon into whose row this one is merged (its own or an earlier or later one; chains are followed).
  std::optional<std::uint32_t> combines_with;
  /// Index of the coplanar polygon on which this one lies like a window in a wall: it is cut out of that one.
  std::optional<std::uint32_t> base;
  double reflectance = 0;  ///< grey, 0..1; 1 - emissivity for opaque surfaces
};

/// Polygons as thermal engineers list them (View3D's .vs3), metres. Plain data: readers fill it, PatchMesh is built
/// from it.
struct PolygonModel {
  std::string title;
  std::vector<Vec3d> vertices;
  std::vector<ModelPolygon> polygons;
};

}  // namespace penumbra
