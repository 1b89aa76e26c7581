#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "penumbra/math/bounds.h"

namespace penumbra {

/// Triangles in double precision, sorted into a tree of boxes, for distances far below what rays resolve.
///
/// All member functions are thread-safe.
class TriangleTree {
 public:
  using Triangle = std::array<Vec3d, 3>;

  explicit TriangleTree(std::vector<Triangle> triangles);

  struct Nearest {
    std::uint32_t triangle = 0;
    Vec3d point{0};       ///< of the triangle
    double distance = 0;  ///< m
  };

  /// The nearest triangle within `within` metres of `p`, of those that `skip` leaves.
  [[nodiscard]] std::optional<Nearest> nearest(const Vec3d& p, double within,
                                               const std::function<bool(std::uint32_t)>& skip) const;

  /// Calls `visit` with every triangle whose box meets `box`, in an order that depends on the triangles alone.
  void overlapping(const Bounds& box, const std::function<void(std::uint32_t)>& visit) const;

  [[nodiscard]] const Triangle& triangle(std::uint32_t index) const { return triangles_[index]; }
  [[nodiscard]] std::size_t size() const { return triangles_.size(); }

 private:
  struct Node {
    Bounds box;
    std::uint32_t first = 0;  // leaf: into order_; else the left child, the right one follows
    std::uint32_t count = 0;  // 0: not a leaf
  };

  void build(std::uint32_t node, std::uint32_t first, std::uint32_t last);

  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// The point of a triangle that lies nearest to `p` (Ericson, "Real-Time Collision Detection", 2005, 5.1.5).
[[nodiscard]] Vec3d nearest_point(const TriangleTree::Triangle& triangle, const Vec3d& p);

}  // namespace penumbra
