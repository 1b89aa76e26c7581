#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// A binary space partition of the patches of a mesh: from any point the fragments in exact order, nearest first
/// (Fuchs, Kedem & Naylor 1980). A patch that straddles another's plane is cut in two.
class BspTree {
 public:
  /// A piece of a patch, convex, with its orientation.
  struct Fragment {
    std::uint32_t patch = 0;
    std::span<const Vec3d> polygon;
  };

  /// The plane of each node is chosen among a few candidates to cut few patches and to balance the rest.
  explicit BspTree(const PatchMesh& mesh, std::uint64_t seed = 0);

  /// Visits all fragments so that none hides one before it. Coplanar ones come together, those that face the eye first.
  void front_to_back(const Vec3d& eye, const std::function<void(const Fragment&)>& visitor) const;
  /// The same, leaving out subtrees wholly behind the half-space `horizon` (distance <= 0).
  void front_to_back(const Vec3d& eye, const Plane3& horizon,
                     const std::function<void(const Fragment&)>& visitor) const;

  [[nodiscard]] std::size_t fragment_count() const { return patch_of_.size(); }
  [[nodiscard]] std::size_t node_count() const { return nodes_.size(); }
  [[nodiscard]] int depth() const { return depth_; }

 private:
  static constexpr std::uint32_t no_node = 0xFFFFFFFFU;
  struct Node {
    Plane3 plane;
    Bounds bounds;  ///< of all fragments below
    std::uint32_t front = no_node, back = no_node;
    std::uint32_t first = 0, middle = 0, last = 0;  ///< fragments on the plane: [first, middle) face as it does
  };
  struct Piece;
  struct Builder;

  [[nodiscard]] std::span<const Vec3d> polygon(std::uint32_t fragment) const {
    return std::span(corners_).subspan(offsets_[fragment], offsets_[fragment + 1] - offsets_[fragment]);
  }

  std::vector<Node> nodes_;
  std::uint32_t root_ = no_node;
  std::vector<std::uint32_t> patch_of_;
  std::vector<std::uint32_t> offsets_{0};
  std::vector<Vec3d> corners_;
  int depth_ = 0;
};

}  // namespace penumbra
