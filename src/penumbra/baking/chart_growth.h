#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/scene/mesh.h"

namespace penumbra {

/// A mesh at its place in the world, ready to be cut into charts.
struct PlacedTriangles {
  std::vector<Vec3d> positions;        ///< m, of the mesh's vertices
  std::vector<Vec3d> area_vectors;     ///< twice the area times the front's normal, by triangle; zero without an area
  std::vector<std::uint32_t> partner;  ///< [triangle * 3 + edge]: the neighbour across edge k (corners k and k + 1)
  static constexpr std::uint32_t no_partner = ~std::uint32_t{0};
};

/// Vertices at equal positions are one. A triangle has at most one neighbour across an edge, of those that run through
/// it the other way the one whose plane is most like its own. Edges between two materials have none, nor do those on
/// which a third face stands like a wall on a floor.
[[nodiscard]] PlacedTriangles place_triangles(const Mesh& mesh, const Mat4d& to_world);

/// Numbers the charts that the triangles fall into, from 0 in order of their first triangles.
///
/// From a triangle a chart grows over edges, nearest first, while normals stay within half of `angle` of its own: so no
/// two of a chart differ by more than `angle`, rad. Triangles without an area join any neighbour.
[[nodiscard]] std::vector<std::uint32_t> grow_charts(const PlacedTriangles& surface, double angle);

/// The same for some of the triangles: sets `chart_of[t]` for each t in `triangles`, from `first` on. Returns the
/// number after the last. @pre `chart_of` is `ungrown` for them and for no other.
std::uint32_t grow_charts(const PlacedTriangles& surface, std::span<const std::uint32_t> triangles, double angle,
                          std::uint32_t first, std::vector<std::uint32_t>& chart_of);
inline constexpr std::uint32_t ungrown = ~std::uint32_t{0};

}  // namespace penumbra
