#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Points in a hierarchy of boxes, to find those that lie on a segment.
class PointTree {
 public:
  /// The points must outlive the tree.
  explicit PointTree(std::span<const Vec3d> points);

  /// Appends the numbers of the points within `tolerance` of the segment, ends included, in any order that depends on
  /// the points alone.
  void on_segment(const Vec3d& a, const Vec3d& b, double tolerance, std::vector<std::uint32_t>& found) const;

 private:
  struct Node {
    Bounds bounds;
    std::uint32_t first, last;  // of order_, in leaves
    std::uint32_t right = 0;    // the left child follows its parent; 0: a leaf
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t last);

  std::span<const Vec3d> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// For each point the number of the first point (by number) that it is within `tolerance` of, itself when there is
/// none before it: equal numbers are one vertex.
[[nodiscard]] std::vector<std::uint32_t> weld_points(std::span<const Vec3d> points, double tolerance);

}  // namespace penumbra
