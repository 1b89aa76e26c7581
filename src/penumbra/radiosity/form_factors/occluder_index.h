#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/patch_clusters.h"

namespace penumbra {

enum class Sight { visible, hidden, partial };

/// Which occluders stand between two clusters of patches, found with a bounding volume hierarchy.
class OccluderIndex {
 public:
  explicit OccluderIndex(const OccluderPolygons& occluders);

  [[nodiscard]] const OccluderPolygons& occluders() const { return occluders_; }
  /// The occluder's plane, then one through each edge, perpendicular to it, its inside in front.
  [[nodiscard]] std::span<const Plane3> planes(std::size_t k) const {
    return std::span(planes_).subspan(plane_offsets_[k], plane_offsets_[k + 1] - plane_offsets_[k]);
  }

  /// Replaces `found` by the occluders that may hide part of one cluster from the other. Returns Sight::hidden when one
  /// of them hides all, visible when there are none.
  [[nodiscard]] Sight between(const PatchClusters::Cluster& a, const PatchClusters::Cluster& b,
                              std::vector<std::uint32_t>& found) const;

  /// Faces of a convex solid whose fronts all of a cluster sees: the first two.
  struct Fronts {
    bool known = false;
    std::uint32_t count = 0;
    std::array<std::uint32_t, 2> faces{};  ///< into the solid's planes
  };
  [[nodiscard]] Fronts fronts(const PatchClusters::Cluster& a, std::uint32_t body) const;

  /// Whether occluder k is the back of a convex solid for all of `a`, which is outside it: it may hide alone what two
  /// fronts hide together, but the union of all that hides is the same without it.
  /// @param fronts those of its solid.
  [[nodiscard]] bool is_back(const PatchClusters::Cluster& a, std::size_t k, const Fronts& fronts) const;

  /// Which side of occluder k all of the cluster is on: +1 its front, -1 its back; 0 when it is on both or in its
  /// plane.
  [[nodiscard]] signed char side(const PatchClusters::Cluster& a, std::size_t k) const;

  /// Bit e: every segment between the two clusters, which are on opposite sides of occluder k, crosses its plane inside
  /// its edge e (below 63).
  [[nodiscard]] std::uint64_t inside_edges(const PatchClusters::Cluster& a, const PatchClusters::Cluster& b,
                                           std::size_t k) const;

  /// How occluder k stands between two convex polygons; `partial` where undecided.
  [[nodiscard]] Sight sight(std::span<const Vec3d> a, std::span<const Vec3d> b, std::size_t k) const;

 private:
  struct Node {
    Bounds bounds;
    std::uint32_t first = 0, count = 0;  // leaves: into order_; inner nodes: count 0, children first and first + 1
  };
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t last);
  [[nodiscard]] Sight examine(const PatchClusters::Cluster& a, const PatchClusters::Cluster& b, std::size_t k) const;

  const OccluderPolygons& occluders_;
  std::vector<std::uint32_t> plane_offsets_{0};
  std::vector<Plane3> planes_;
  std::vector<double> body_slack_;  // per convex solid, the most of its faces
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace penumbra
