#include "penumbra/radiosity/form_factors/cluster_sight.h"

#include <algorithm>
#include <array>
#include <limits>

#include "penumbra/radiosity/form_factors/shaft.h"

namespace penumbra {
namespace {

constexpr std::uint32_t all_lanes = (1U << PatchClusters::lanes) - 1U;
constexpr std::size_t most_kept = 1U << 20;  // numbers in the tables of one cluster
constexpr double plane_margin = 8;           // times an occluder's slack: closer to a plane it touches it

}  // namespace

ClusterSight::ClusterSight(const OccluderIndex& index, const PatchClusters& clusters)
    : index_(index),
      clusters_(clusters),
      fronts_of_(clusters.size()),
      listed_of_(index.occluders().size()),
      table_of_first_(index.occluders().size()) {}

Vec3d ClusterSight::centroid(std::size_t slot) const {
  return {clusters_.centroid[0][slot], clusters_.centroid[1][slot], clusters_.centroid[2][slot]};
}

/// The lanes of a cluster whose patches' planes occluder k is clear above, and those that it is behind.
ClusterSight::Lanes ClusterSight::against_planes(std::size_t cluster, std::uint32_t k) const {
  constexpr std::size_t lanes = PatchClusters::lanes;
  const std::size_t first = cluster * lanes;
  std::array<double, lanes> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (const Vec3d& v : index_.occluders().polygon(k)) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t slot = first + lane;
      const double height = clusters_.normal[0][slot] * v.x + clusters_.normal[1][slot] * v.y +
                            clusters_.normal[2][slot] * v.z - clusters_.offset[slot];
      low[lane] = std::min(low[lane], height);
      high[lane] = std::max(high[lane], height);
    }
  }
  const double slack = index_.occluders().slack[k];
  Lanes found;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    if (low[lane] > plane_margin * slack) found.above |= 1U << lane;
    if (high[lane] <= slack) found.behind |= 1U << lane;
  }
  return found;
}

/// Whether for all of cluster a occluder k is the back of a convex solid.
bool ClusterSight::is_back(std::uint32_t k) {
  const std::uint32_t body = index_.occluders().body[k];
  if (body == ConvexBodies::no_body) return false;
  if (fronts_of_ != a_) {
    fronts_.assign(index_.occluders().bodies.size(), {});
    fronts_of_ = a_;
  }
  if (!fronts_[body].known) fronts_[body] = index_.fronts(clusters_.clusters[a_], body);
  return index_.is_back(clusters_.clusters[a_], k, fronts_[body]);
}

/// Where an occluder is in listed_, `dropped`, or `none`.
std::uint32_t ClusterSight::listed_at(std::uint32_t occluder) const {
  return listed_of_[occluder].first == now_ ? listed_of_[occluder].second : none;
}

void ClusterSight::list() {
  const auto& first = clusters_.clusters[a_];
  const auto& second = clusters_.clusters[b_];
  if (++now_ == 0) {
    std::fill(listed_of_.begin(), listed_of_.end(), std::pair{0U, 0U});
    now_ = 1;
  }
  listed_.clear();
  for (std::uint32_t k : found_) {
    Listed one;
    one.occluder = k;
    const Lanes at_a = against_planes(a_, k), at_b = against_planes(b_, k);
    if (at_a.behind == all_lanes || at_b.behind == all_lanes) continue;  // as if it had not been found
    // What is seen from behind hides nothing that the fronts do not.
    if (is_back(k)) {
      listed_of_[k] = {now_, dropped};
      continue;
    }
    one.above_a = at_a.above;
    one.above_b = at_b.above;
    one.behind_a = at_a.behind;
    one.behind_b = at_b.behind;
    one.side_a = index_.side(first, k);
    one.side_b = index_.side(second, k);
    one.clear = one.above_a == all_lanes && one.above_b == all_lanes;
    one.surface = all_lanes;
    listed_of_[k] = {now_, static_cast<std::uint32_t>(listed_.size())};
    listed_.push_back(one);
  }
}

/// Adds an edge when something may begin or end to hide there and a line may pass it.
void ClusterSight::add_rim(std::uint32_t n, std::uint32_t corner) {
  const OccluderPolygons& occluders = index_.occluders();
  Listed& own = listed_[n];
  const std::uint32_t e = occluders.corner_edges[occluders.corner_offsets[own.occluder] + corner];
  const OccluderPolygons::Edge& edge = occluders.edges[e];
  RimEdge rim;
  rim.first = n;
  rim.first_corner = corner;
  const std::uint32_t other = edge.left == own.occluder ? edge.right : edge.left;
  if (edge.simple && other != none) {
    const std::uint32_t m = listed_at(other);
    if (m == none) return;  // no line passes what was not found, so none passes the edge
    if (m != dropped) {
      Listed& neighbour = listed_[m];
      const bool alike = edge.flat || (own.side_a != 0 && own.side_a == neighbour.side_a) ||
                         (own.side_b != 0 && own.side_b == neighbour.side_b);
      if (alike && own.clear && neighbour.clear) return;
      if (m < n) return;  // added with the other
      rim.second = m;
      rim.flat = edge.flat;
      const std::size_t first = occluders.corner_offsets[other];
      while (occluders.corner_edges[first + rim.second_corner] != e) ++rim.second_corner;
    }
  }
  rims_.push_back(rim);
}

void ClusterSight::find_rims() {
  rims_.clear();
  const OccluderPolygons& occluders = index_.occluders();
  for (std::uint32_t n = 0; n < listed_.size(); ++n) {
    const std::uint32_t k = listed_[n].occluder;
    const std::uint32_t count = occluders.corner_offsets[k + 1] - occluders.corner_offsets[k];
    for (std::uint32_t c = 0; c < count; ++c) add_rim(n, c);
  }
}

/// Forgets the rims that no line between the clusters passes.
void ClusterSight::drop_rims_aside() {
  edges_inside_.assign(listed_.size(), 0);
  for (const RimEdge& rim : rims_) {
    listed_[rim.first].rim = true;
    if (rim.second != none) listed_[rim.second].rim = true;
  }
  for (std::size_t n = 0; n < listed_.size(); ++n) {
    Listed& one = listed_[n];
    if (one.rim && one.side_a != 0 && one.side_a == -one.side_b)
      edges_inside_[n] = index_.inside_edges(clusters_.clusters[a_], clusters_.clusters[b_], one.occluder);
    one.rim = false;
  }
  const auto inside = [&](std::uint32_t n, std::uint32_t corner) {
    return corner < 63 && ((edges_inside_[n] >> corner) & 1) != 0;
  };
  std::erase_if(rims_, [&](const RimEdge& rim) {
    return inside(rim.first, rim.first_corner) || (rim.second != none && inside(rim.second, rim.second_corner));
  });
  for (const RimEdge& rim : rims_) {
    listed_[rim.first].rim = true;
    if (rim.second != none) listed_[rim.second].rim = true;
  }
}

/// Where the corner distances of cluster a from occluder k are.
std::size_t ClusterSight::table_of_first(std::uint32_t k) {
  auto& [of, at] = table_of_first_[k];
  if (of == tables_of_) return at;
  const auto planes = index_.planes(k);
  of = tables_of_;
  at = used_a_;
  used_a_ += planes.size() * clusters_.clusters[a_].corner_count * PatchClusters::lanes;
  if (tables_a_.size() < used_a_) tables_a_.resize(2 * used_a_);
  corner_distances(clusters_, a_, planes, tables_a_.data() + at);
  return at;
}

void ClusterSight::make_tables() {
  if (kept_of_ != a_ || used_a_ > most_kept) {
    kept_of_ = a_;
    ++tables_of_;
    used_a_ = 0;
  }
  std::size_t used = 0, edges = 0;
  for (Listed& one : listed_) {
    if (one.silent()) continue;
    const auto planes = index_.planes(one.occluder);
    one.inside = edges;
    edges += planes.size() - 1;
    one.table_a = table_of_first(one.occluder);
    one.table_b = used;
    used += planes.size() * clusters_.clusters[b_].corner_count * PatchClusters::lanes;
    if (tables_b_.size() < used) tables_b_.resize(2 * used);
    corner_distances(clusters_, b_, planes, tables_b_.data() + one.table_b);
  }
  inside_.resize(std::max(inside_.size(), edges));
}

/// Whether the line between the clusters' first patches is hidden.
bool ClusterSight::first_centres_hidden() const {
  const Vec3d p = centroid(a_ * PatchClusters::lanes);
  return std::any_of(listed_.begin(), listed_.end(), [&](const Listed& one) {
    return (hidden_centroids(clusters_, p, b_, index_.planes(one.occluder), index_.occluders().slack[one.occluder]) &
            1U) != 0;
  });
}

Sight ClusterSight::begin(std::size_t a, std::size_t b) {
  a_ = a;
  b_ = b;
  const Sight sight = index_.between(clusters_.clusters[a], clusters_.clusters[b], found_);
  if (sight != Sight::partial) return sight;
  list();
  find_rims();
  drop_rims_aside();
  const bool clear = std::all_of(listed_.begin(), listed_.end(), [](const Listed& one) { return one.clear; });
  if (rims_.empty() && clear) return first_centres_hidden() ? Sight::hidden : Sight::visible;
  make_tables();
  return Sight::partial;
}

void ClusterSight::find_live_rims(std::uint32_t facing) {
  for (RimEdge& rim : rims_) {
    const Listed& first = listed_[rim.first];
    std::uint32_t passed = facing & ~first.seen.visible & ~inside_[first.inside + rim.first_corner];
    rim.live_first = passed & first.surface;
    rim.live_second = 0;
    if (rim.second == none) continue;
    const Listed& second = listed_[rim.second];
    passed &= ~second.seen.visible & ~inside_[second.inside + rim.second_corner];
    const bool same_side = rim.flat || (first.seen.side != 0 && first.seen.side == second.seen.side);
    std::uint32_t inner =
        same_side ? ~0U : (first.seen.front & second.seen.front) | (first.seen.back & second.seen.back);
    inner &= first.surface & second.surface;
    rim.live_first &= passed & ~inner;
    rim.live_second = passed & second.surface & ~inner;
  }
}

/// Removes from `facing` the lanes that one line shows to be hidden.
void ClusterSight::settle(std::uint32_t settled, std::uint32_t& facing) const {
  const Vec3d p = centroid(a_ * PatchClusters::lanes + lane_);
  for (const Listed& one : listed_) {
    const std::uint32_t lanes = settled & facing & (one.silent() ? ~0U : ~one.seen.visible);
    if (lanes != 0)
      facing &= ~(lanes & hidden_centroids(clusters_, p, b_, index_.planes(one.occluder),
                                           index_.occluders().slack[one.occluder]));
  }
}

Bounds ClusterSight::bounds_of_patch(std::size_t lane) const {
  const PatchClusters::Cluster& cluster = clusters_.clusters[a_];
  Bounds bounds;
  for (std::size_t k = 0; k < cluster.corner_count; ++k)
    bounds.grow({clusters_.corner(cluster, k, 0)[lane], clusters_.corner(cluster, k, 1)[lane],
                 clusters_.corner(cluster, k, 2)[lane]});
  return bounds;
}

std::uint32_t ClusterSight::look(std::size_t lane, std::uint32_t& facing) {
  lane_ = lane;
  std::uint32_t unsettled = 0;
  const Shaft shaft(bounds_of_patch(lane), clusters_.clusters[b_].bounds);
  for (Listed& one : listed_) {
    if (one.silent()) continue;
    if (((one.behind_a >> lane) & 1) != 0 || shaft.misses(index_.occluders().bounds[one.occluder])) {
      one.seen = {};
      one.seen.visible = ~0U;
      continue;
    }
    one.seen = lane_visibility(clusters_, a_, lane, tables_a_.data() + one.table_a, b_, tables_b_.data() + one.table_b,
                               index_.planes(one.occluder).size(), index_.occluders().slack[one.occluder], facing,
                               inside_.data() + one.inside);
    one.seen.visible |= one.behind_b;
    one.seen.hidden &= ~one.behind_b;
    one.surface = ((one.above_a >> lane) & 1) != 0 ? one.above_b : 0;
    facing &= ~one.seen.hidden;
    if (facing == 0) return 0;
    unsettled |= ~one.surface & ~one.seen.visible;
  }
  find_live_rims(facing);
  for (const RimEdge& rim : rims_) unsettled |= rim.live_first | rim.live_second;
  settle(~unsettled, facing);
  return unsettled & facing;
}

bool ClusterSight::has_loose(std::size_t l) const {
  return std::any_of(listed_.begin(), listed_.end(),
                     [&](const Listed& one) { return ((~one.surface & ~one.seen.visible) >> l & 1) != 0; });
}

std::span<const std::uint32_t> ClusterSight::occluders(std::size_t l) {
  occluders_.clear();
  for (const Listed& one : listed_)
    if (one.silent() || (one.seen.visible >> l & 1) == 0) occluders_.push_back(one.occluder);
  return occluders_;
}

Silhouette::Surface ClusterSight::surface(std::size_t l) {
  rims_of_pair_.clear();
  for (const RimEdge& rim : rims_) {
    if ((rim.live_first >> l & 1) != 0) rims_of_pair_.push_back({listed_[rim.first].occluder, rim.first_corner});
    if ((rim.live_second >> l & 1) != 0) rims_of_pair_.push_back({listed_[rim.second].occluder, rim.second_corner});
  }
  return {rims_of_pair_, occluders(l)};
}

}  // namespace penumbra
