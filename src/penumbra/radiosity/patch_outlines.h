#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/point_tree.h"

namespace penumbra {

/// The outlines of a mesh's patches with every vertex that lies within an edge inserted: so patches that meet share
/// whole edges, also where a corner of one is in the middle of the other's edge (a T-vertex).
///
/// Vertices closer than a tolerance are one. The mesh must outlive the outlines.
class PatchOutlines {
 public:
  /// @param tolerance m.
  PatchOutlines(const PatchMesh& mesh, double tolerance);

  [[nodiscard]] std::size_t corner_count() const { return ring_.size(); }
  /// The first corner's number of a patch; its corners follow.
  [[nodiscard]] std::uint32_t first_corner(std::size_t patch) const { return offsets_[patch]; }
  /// Vertices of the mesh, counter-clockwise seen from the front.
  [[nodiscard]] std::span<const std::uint32_t> ring(std::size_t patch) const {
    return std::span(ring_).subspan(offsets_[patch], offsets_[patch + 1] - offsets_[patch]);
  }
  [[nodiscard]] const Vec3d& position(std::uint32_t vertex) const { return mesh_.vertices[vertex]; }

 private:
  void insert_between(const PointTree& tree, std::uint32_t a, std::uint32_t b, double tolerance);

  const PatchMesh& mesh_;
  std::vector<std::uint32_t> welded_;
  std::vector<std::uint32_t> ring_;
  std::vector<std::uint32_t> offsets_{0};
  std::vector<std::uint32_t> found_;
};

}  // namespace penumbra
