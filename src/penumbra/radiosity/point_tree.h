#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/radiosity/box_tree.h"

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
  std::span<const Vec3d> points_;
  BoxTree tree_;
};

/// For each point the number of the first point (by number) that it is within `tolerance` of, itself when there is
/// none before it: equal numbers are one vertex.
[[nodiscard]] std::vector<std::uint32_t> weld_points(std::span<const Vec3d> points, double tolerance);

}  // namespace penumbra
