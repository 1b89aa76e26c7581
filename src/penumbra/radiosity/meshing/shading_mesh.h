#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

struct ShadingMeshOptions {
  double crease_angle = 0.5235987755982988;  ///< rad; elements whose normals differ by more are not blended
  double weld_tolerance = 1e-7;              ///< of the mesh's size; corners closer than that are one
};

/// Elements as triangles for smooth display: no corner of a triangle lies inside another's edge, and values of the
/// elements pass into values at vertices that are interpolated linearly.
///
/// Corners of elements that lie within a neighbour's edge are inserted there; an element that has some becomes a fan
/// about its centre (the purpose of the anchored meshes of Baum, Mann, Smith & Winget 1991). A position has one vertex
/// for each sheet of elements that pass smoothly into one another there: elements are blended across an edge when it
/// is the edge of just two faces, seen from the same side, without crease. So nothing is blended over the edge of a
/// box, through a wall that stands on the floor, or between front and back.
///
/// Blend what is smooth, the irradiance, and multiply by each element's own reflectance: neighbours of different
/// materials then keep their colours.
struct ShadingMesh {
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Vec3d> positions;     ///< of the vertices, m
  std::vector<Vec3d> normals;       ///< unit, mean of the elements around
  std::vector<Triangle> triangles;  ///< counter-clockwise seen from the side that radiates, ordered by element
  std::vector<std::uint32_t> element_of_triangle;

  /// The elements that a vertex takes its value from: entries [offsets[v], offsets[v + 1]); weights sum to 1.
  std::vector<std::uint32_t> offsets{0};
  std::vector<std::uint32_t> elements;
  std::vector<double> weights;

  [[nodiscard]] std::size_t vertex_count() const { return positions.size(); }
  /// Values at the vertices, [vertex * bands + band], from values of the elements, [element * bands + band]. Weighted
  /// by the angle of each element at the vertex, corrected so that what is linear in the plane is reproduced where
  /// elements lie all around.
  [[nodiscard]] std::vector<double> at_vertices(std::span<const double> of_elements, std::size_t bands) const;
};

/// @param elements each patch an element.
[[nodiscard]] ShadingMesh make_shading_mesh(const PatchMesh& elements, const ShadingMeshOptions& options = {});

}  // namespace penumbra
