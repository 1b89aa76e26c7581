#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A face cut into convex cells, one more cut at a time.
class FaceCells {
 public:
  using Cell = std::vector<Vec3d>;

  FaceCells() = default;
  explicit FaceCells(std::vector<Cell> cells) : cells_(std::move(cells)) {}

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }

  /// Cuts every cell that a segment of the face's plane passes through, from edge to edge: tips of the segment are
  /// extended to the cell's outline. Parts of the cell narrower than `snap` (m) are not cut off. Returns how many cells
  /// were cut.
  std::size_t cut_along(const Vec3d& a, const Vec3d& b, const Vec3d& normal, double snap);

 private:
  std::vector<Cell> cells_;
};

/// Halves a cell across its edge `edge`: a triangle or quadrilateral from the middle of that edge to the opposite
/// corner or middle, any other polygon by halve_polygon. Both parts are oriented as the cell.
void halve_cell(std::span<const Vec3d> cell, std::size_t edge, std::vector<Vec3d>& first, std::vector<Vec3d>& second);

}  // namespace penumbra
