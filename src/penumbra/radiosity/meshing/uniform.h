#pragma once

#include <cstddef>

#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// How a scene becomes elements.
struct MeshingOptions {
  /// Longest edge allowed, m. A rectangle becomes a regular grid of ceil(edge / size) cells each way. 0: no limit.
  double element_size = 0;
  /// About this many elements: the size is chosen to meet it. Used when element_size is 0; 0: one element an input
  /// polygon.
  std::size_t element_count = 0;
  PatchSides sides = PatchSides::both;
  int shape_segments = 32;  ///< spheres, disks and cylinders become polygons, this many around
};

/// The faces of a scene cut into elements: each element is one patch and one surface of the mesh, whose `face`,
/// `object` and `back` name the input polygon. Reflectance and emission are the averages of their textures over the
/// element; reflectance = base colour (1 - metallic) (1 - transmission). Elements have good aspect: rectangles and
/// parallelograms become grids, triangles similar triangles, other polygons pieces of both. Neighbours that share an
/// edge divide it alike where both are rectangles; elsewhere corners may lie within a neighbour's edge, which
/// `ShadingMesh` mends. Throws std::invalid_argument as make_patch_mesh does.
[[nodiscard]] MadePatchMesh make_uniform_elements(const Scene& scene, const MeshingOptions& options);

/// The longest edge (m) with which divide_polygon cuts the radiating patches of `faces` into about `wanted` cells; by
/// bisection.
[[nodiscard]] double size_for_count(const PatchMesh& faces, std::size_t wanted);

}  // namespace penumbra
