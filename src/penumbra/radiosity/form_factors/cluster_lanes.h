#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/patch_clusters.h"

namespace penumbra {

// One patch against the sixteen of a cluster, side by side. Bit l of a mask is lane l.

/// What a patch exchanges with each patch of a cluster when nothing is in between.
struct LaneExchange {
  alignas(64) double exchange[PatchClusters::lanes];  ///< m^2, by the kernel cos cos / (pi r^2) at 4 x 4 points
  alignas(64) double error[PatchClusters::lanes];     ///< m^2, an estimate; large where the patches are close
  std::uint32_t facing = 0;                           ///< each sees some of the other's front
  std::uint32_t straddling = 0;                       ///< the plane of one cuts through the other
};

/// @param tolerance what lies within it of a plane counts as lying on it, m.
void far_exchange(const PatchClusters& clusters, std::size_t slot, std::size_t cluster, double tolerance,
                  LaneExchange& out);

/// Replaces exchange and error in the lanes of `wanted` by those of the 9 x 9 point rule, where it has one and its
/// error is smaller.
void refine_exchange(const PatchClusters& clusters, std::size_t slot, std::size_t cluster, std::uint32_t wanted,
                     LaneExchange& out);

/// Signed distances of a cluster's corners from some planes: table[(plane * corner_count + corner) * lanes + lane].
void corner_distances(const PatchClusters& clusters, std::size_t cluster, std::span<const Plane3> planes,
                      double* table);

struct LaneVisibility {
  std::uint32_t visible = 0;  ///< the occluder leaves every line between the two patches free
  std::uint32_t hidden = 0;   ///< it cuts all of them
  std::uint32_t front = 0;    ///< the second patch is in front of its plane, or on it
  std::uint32_t back = 0;     ///< ... behind it, or on it
  signed char side = 0;       ///< of the first patch: +1 in front, -1 behind, 0 on both or in the plane
};

/// How an occluder stands between the patch in lane `lane` of cluster `first` and each patch of cluster `second`. Exact
/// up to `slack`: the test function is bilinear in the segment's ends, so corners decide; of patches that the
/// occluder's plane cuts, those of the parts on either side.
/// @param planes of the occluder: its own, then one through each edge, perpendicular to it, inwards. @param
/// first_table, second_table their corner_distances. @param wanted only these lanes need an answer. @param inside
/// receives for each edge the lanes of which no line leaves the occluder across it, if they are not visible.
[[nodiscard]] LaneVisibility lane_visibility(const PatchClusters& clusters, std::size_t first, std::size_t lane,
                                             const double* first_table, std::size_t second, const double* second_table,
                                             std::size_t planes, double slack, std::uint32_t wanted,
                                             std::uint32_t* inside);

/// The lanes of a cluster whose centroids the occluder hides from a point.
/// @param planes of the occluder: its own, then one through each edge, perpendicular to it, inwards.
[[nodiscard]] std::uint32_t hidden_centroids(const PatchClusters& clusters, const Vec3d& point, std::size_t cluster,
                                             std::span<const Plane3> planes, double slack);

}  // namespace penumbra
