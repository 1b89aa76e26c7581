#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "penumbra/radiosity/form_factors/cluster_lanes.h"
#include "penumbra/radiosity/form_factors/occluder_index.h"
#include "penumbra/radiosity/form_factors/patch_clusters.h"
#include "penumbra/radiosity/form_factors/silhouette.h"

namespace penumbra {

/// What stands between two clusters of patches, and between one patch of the first and each of the second.
///
/// The occluders form a *surface*. While a line's ends move over two patches the number of polygons that it passes
/// changes only at the surface's *rims*: edges without a neighbour, or with one that turns its other side. A pair of
/// patches between which no line passes a rim is settled by one line: all are free or none. For the others the rims are
/// all that matters. Occluders that touch one of the two patches' planes are *loose*: they end at horizons, where other
/// edges come up.
///
/// One object a thread.
class ClusterSight {
 public:
  ClusterSight(const OccluderIndex& index, const PatchClusters& clusters);

  /// Looks from cluster a to cluster b: all hidden, all visible, or partial.
  Sight begin(std::size_t a, std::size_t b);

  /// Looks from one patch of a. Removes from `facing` the lanes of b that are hidden. Returns those that may be hidden
  /// in part. @pre begin() said partial.
  std::uint32_t look(std::size_t lane, std::uint32_t& facing);

  /// Whether loose occluders may hide a part of lane l from that patch.
  [[nodiscard]] bool has_loose(std::size_t l) const;
  /// What stands between that patch and lane l: all occluders. Valid until the next call.
  [[nodiscard]] std::span<const std::uint32_t> occluders(std::size_t l);
  /// The same as a surface, when none of them is loose.
  [[nodiscard]] Silhouette::Surface surface(std::size_t l);

 private:
  static constexpr std::uint32_t none = OccluderPolygons::none, dropped = none - 1;
  struct Listed {
    std::uint32_t occluder = 0;
    signed char side_a = 0, side_b = 0;        // that the clusters are on, 0: on both
    std::uint32_t above_a = 0, above_b = 0;    // lanes of the clusters whose patches' planes it is clear above
    std::uint32_t behind_a = 0, behind_b = 0;  // and those that it is behind, where it hides nothing
    bool clear = false;                        // above all of them
    std::uint32_t surface = 0;                 // lanes of b for which it is of the surface, from the lane looked from
    bool rim = false;                          // has an edge in rims_
    std::size_t table_a = 0, table_b = 0;      // its corner distances in tables_a_ and tables_b_
    std::size_t inside = 0;                    // its edges' lanes in inside_
    LaneVisibility seen;                       // from the lane looked from
    [[nodiscard]] bool silent() const { return clear && !rim; }
  };
  /// An edge of one polygon, or of two that are joined there.
  struct RimEdge {
    std::uint32_t first = 0, first_corner = 0;  // into listed_
    std::uint32_t second = none, second_corner = 0;
    bool flat = false;
    std::uint32_t live_first = 0, live_second = 0;  // lanes in which it is a rim of the first, of the second
  };
  void list();
  struct Lanes {
    std::uint32_t above = 0, behind = 0;
  };
  [[nodiscard]] Lanes against_planes(std::size_t cluster, std::uint32_t k) const;
  [[nodiscard]] bool is_back(std::uint32_t k);
  [[nodiscard]] std::uint32_t listed_at(std::uint32_t occluder) const;
  void find_rims();
  void add_rim(std::uint32_t n, std::uint32_t corner);
  void drop_rims_aside();
  void make_tables();
  [[nodiscard]] std::size_t table_of_first(std::uint32_t k);
  [[nodiscard]] bool first_centres_hidden() const;
  void find_live_rims(std::uint32_t facing);
  void settle(std::uint32_t settled, std::uint32_t& facing) const;
  [[nodiscard]] Vec3d centroid(std::size_t slot) const;
  [[nodiscard]] Bounds bounds_of_patch(std::size_t lane) const;

  const OccluderIndex& index_;
  const PatchClusters& clusters_;
  std::size_t a_ = 0, b_ = 0, lane_ = 0;
  std::vector<std::uint32_t> found_;
  std::vector<OccluderIndex::Fronts> fronts_;  // per convex solid, those that cluster fronts_of_ sees
  std::size_t fronts_of_ = 0;
  std::vector<Listed> listed_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> listed_of_;  // per occluder: when it was listed last, and where
  std::uint32_t now_ = 0;
  std::vector<RimEdge> rims_;
  std::vector<std::uint64_t> edges_inside_;  // per listed: edges that no segment between the clusters leaves across
  // Those of cluster a are kept while it stays: per occluder its stamp and where they begin.
  std::vector<double> tables_a_, tables_b_;
  std::vector<std::pair<std::size_t, std::size_t>> table_of_first_;
  std::size_t kept_of_ = std::size_t(-1), tables_of_ = 0, used_a_ = 0;  // the cluster, its stamp, numbers in use
  std::vector<std::uint32_t> inside_;
  std::vector<std::uint32_t> occluders_;
  std::vector<Silhouette::Rim> rims_of_pair_;
};

}  // namespace penumbra
