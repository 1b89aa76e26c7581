#include "penumbra/radiosity/form_factors/auto.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/cluster_lanes.h"
#include "penumbra/radiosity/form_factors/cluster_sight.h"
#include "penumbra/radiosity/form_factors/obstructed_exchange.h"
#include "penumbra/radiosity/form_factors/occluder_index.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/patch_clusters.h"

namespace penumbra {
namespace {

// Blocks: so many clusters against so many, fewer in small meshes so that every thread has some.
constexpr std::size_t most_block_rows = 8, block_columns = 64, fewest_bands = 48;

// How the tolerance is shared out. A pair may err by tolerance * (by_area * A_i A_j / A_total + by_value * exchange):
// summed over j and divided by A_i each part is at most its share.
constexpr double dropped_by_area = 0.1;
constexpr double visible_by_area = 0.15, visible_by_value = 0.15;
constexpr double partial_by_area = 0.3, partial_by_value = 0.3;
// Partly hidden pairs are few and costly. A survey of some rows finds which part of a row they make up at most, and
// they share out what is meant for all; `survey_margin` times that part, since other rows may hold more.
constexpr double survey_margin = 1.5;
// One of few such pairs in a row is estimated by the most that its error can be; of many the mean matters.
constexpr double cautious_pairs = 4;
constexpr std::size_t survey_step = 4;  // of some clusters' patches every fourth is surveyed

}  // namespace

struct AutoFormFactors::Impl {
  Impl(const PatchMesh& m, const FormFactorOptions& o, const Settings& s)
      : mesh(m),
        options(o),
        settings(s),
        shared_occluders(s.occluders != nullptr
                             ? s.occluders
                             : std::make_shared<const OccluderPolygons>(make_occluder_polygons(m, s.merge_occluders))),
        occluders(*shared_occluders),
        index(occluders),
        clusters(make_patch_clusters(m)) {
    Bounds all;
    for (const Vec3d& v : mesh.vertices) all.grow(v);
    coplanar = 1e-9 * all.diagonal();
    for (std::size_t p = 0; p < mesh.radiating_count; ++p) total_area += mesh.areas[p];
    slot_of.resize(mesh.radiating_count);
    for (std::size_t a = 0; a < clusters.size(); ++a)
      for (std::size_t lane = 0; lane < clusters.clusters[a].count; ++lane)
        slot_of[clusters.patch[a * PatchClusters::lanes + lane]] =
            static_cast<std::uint32_t>(a * PatchClusters::lanes + lane);
    const std::size_t block_rows = std::clamp(clusters.size() / fewest_bands, std::size_t{1}, most_block_rows);
    const std::size_t rows = (clusters.size() + block_rows - 1) / block_rows;
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t column = r * block_rows; column < clusters.size(); column += block_columns)
        blocks.push_back({r * block_rows, std::min((r + 1) * block_rows, clusters.size()), column});
    survey();
  }

  struct Block {
    std::size_t row, row_end, column;  // clusters; the columns go on for block_columns
  };
  /// What part of a row its partly hidden pairs are, by area and by exchange.
  struct Survey {
    double by_area = 0, by_value = 0;
    double pairs = 0;  // how many there are
  };
  void survey();
  [[nodiscard]] std::size_t survey_step_of_patches() const {
    return clusters.size() > settings.surveyed_clusters ? survey_step : 1;
  }
  struct Worker;

  const PatchMesh& mesh;
  FormFactorOptions options;
  Settings settings;
  std::shared_ptr<const OccluderPolygons> shared_occluders;
  const OccluderPolygons& occluders;
  OccluderIndex index;
  PatchClusters clusters;
  std::vector<std::uint32_t> slot_of;  // per radiating patch
  double coplanar = 0;                 // m, what lies within it of a plane lies on it
  double total_area = 0;
  double partial_by_area_all = partial_by_area, partial_by_value_all = partial_by_value;
  double caution = 1;  // of a partly hidden pair's estimate, one of many in a row
  std::vector<Block> blocks;
};

/// One block's work: scratch memory and the result.
struct AutoFormFactors::Impl::Worker {
  explicit Worker(const Impl& i) : impl(i), sight(i.index, i.clusters), obstructed(i.occluders) {
    obstructed.set_caution(i.caution);
  }

  void run(const Block& block);
  void run_row(std::uint32_t patch);
  void cluster_pair(std::size_t a, std::size_t b);
  void patch_row(std::size_t a, std::size_t lane, std::size_t b);
  [[nodiscard]] std::uint32_t same_surface(std::size_t slot, std::size_t cluster) const;
  void refine_where_needed(std::size_t slot, std::size_t cluster, std::uint32_t facing);
  void patch_pair(std::size_t slot_i, std::size_t slot_j, bool straddling, bool in_part);
  void partial_pair(std::size_t slot_i, std::size_t slot_j, bool straddling);
  void visible_pair(std::uint32_t i, std::uint32_t j, bool straddling, const ExchangeEstimate& estimate);
  [[nodiscard]] ExchangeEstimate near_exchange(std::uint32_t i, std::uint32_t j);
  void drop(std::size_t slot_i, std::size_t slot_j, double exchange);
  void set_obstructed(std::uint32_t i, std::uint32_t j, std::size_t lane);
  void emit(std::uint32_t i, std::uint32_t j, const ExchangeEstimate& e);

  const Impl& impl;
  FactorBlock out;
  ClusterSight sight;
  ObstructedExchange obstructed;
  ExchangeAreaScratch analytic;
  LaneExchange open;
  bool disturbed = false;                       // something stands between the two clusters
  std::size_t first_row = 0, first_column = 0;  // slots
  std::vector<double> dropped_rows, dropped_columns;
  std::size_t only_lane = PatchClusters::lanes;  // of the first clusters; `lanes`: each lane, and each pair once
  std::vector<Survey>* surveys = nullptr;        // per lane of the surveyed cluster, while surveying
};

void AutoFormFactors::Impl::Worker::emit(std::uint32_t i, std::uint32_t j, const ExchangeEstimate& e) {
  if (!(e.exchange > 0) && !(e.error > 0)) return;
  out.pairs.push_back({std::min(i, j), std::max(i, j), e.exchange, static_cast<float>(e.error)});
}

void AutoFormFactors::Impl::Worker::drop(std::size_t slot_i, std::size_t slot_j, double exchange) {
  dropped_rows[slot_i - first_row] += exchange;
  dropped_columns[slot_j - first_column] += exchange;
}

void AutoFormFactors::Impl::Worker::set_obstructed(std::uint32_t i, std::uint32_t j, std::size_t lane) {
  const PatchMesh& m = impl.mesh;
  // Integrate over the smaller: the other one's factor is exact.
  if (m.areas[j] < m.areas[i] * (1 - 1e-9)) std::swap(i, j);
  const Plane3 plane_i{m.normals[i], dot(m.normals[i], m.centroids[i])};
  const Plane3 plane_j{m.normals[j], dot(m.normals[j], m.centroids[j])};
  const ExchangeEstimate unobstructed{open.exchange[lane],
                                      ((open.straddling >> lane) & 1) != 0 ? 1e300 : open.error[lane]};
  if (sight.has_loose(lane))
    obstructed.set_pair(m.polygon(i), plane_i, m.polygon(j), plane_j, sight.occluders(lane), unobstructed);
  else
    obstructed.set_pair(m.polygon(i), plane_i, m.polygon(j), plane_j, sight.surface(lane), unobstructed);
}

/// The closed form: no rule's own error estimate can be trusted where patches touch.
ExchangeEstimate AutoFormFactors::Impl::Worker::near_exchange(std::uint32_t i, std::uint32_t j) {
  return {exchange_area(impl.mesh.polygon(i), impl.mesh.polygon(j), analytic),
          1e-12 * std::min(impl.mesh.areas[i], impl.mesh.areas[j])};
}

void AutoFormFactors::Impl::Worker::patch_pair(std::size_t slot_i, std::size_t slot_j, bool straddling, bool in_part) {
  const std::uint32_t i = impl.clusters.patch[slot_i], j = impl.clusters.patch[slot_j];
  const double exchange = open.exchange[slot_j % PatchClusters::lanes];
  const double error = open.error[slot_j % PatchClusters::lanes];
  const double by_area = impl.options.tolerance * impl.mesh.areas[i] * impl.mesh.areas[j] / impl.total_area;
  if (!straddling && exchange + error <= dropped_by_area * by_area) {
    drop(slot_i, slot_j, exchange + error);
  } else if (in_part) {
    partial_pair(slot_i, slot_j, straddling);
  } else {
    visible_pair(i, j, straddling, {exchange, error});
  }
}

void AutoFormFactors::Impl::Worker::visible_pair(std::uint32_t i, std::uint32_t j, bool straddling,
                                                 const ExchangeEstimate& estimate) {
  const double tolerance = impl.options.tolerance;
  const double by_area = tolerance * impl.mesh.areas[i] * impl.mesh.areas[j] / impl.total_area;
  // Where rule points nearly meet they say anything: no pair exchanges more than the smaller area.
  const double most = std::min({estimate.exchange, impl.mesh.areas[i], impl.mesh.areas[j]});
  const double allowed = visible_by_area * by_area + visible_by_value * tolerance * most;
  emit(i, j, !straddling && estimate.error <= allowed ? estimate : near_exchange(i, j));
}

void AutoFormFactors::Impl::Worker::partial_pair(std::size_t slot_i, std::size_t slot_j, bool straddling) {
  const std::uint32_t i = impl.clusters.patch[slot_i], j = impl.clusters.patch[slot_j];
  const std::size_t lane = slot_j % PatchClusters::lanes;
  set_obstructed(i, j, lane);
  if (obstructed.uniform()) {
    if (!obstructed.covered()) visible_pair(i, j, straddling, {open.exchange[lane], open.error[lane]});
    return;
  }
  const double tolerance = impl.options.tolerance;
  const double by_area = tolerance * impl.mesh.areas[i] * impl.mesh.areas[j] / impl.total_area;
  emit(i, j,
       obstructed.integrate(impl.partial_by_area_all * by_area, impl.partial_by_value_all * tolerance,
                            impl.settings.max_cells));
}

/// Takes the finer rule for the lanes whose error is more than a visible pair is allowed.
void AutoFormFactors::Impl::Worker::refine_where_needed(std::size_t slot, std::size_t cluster, std::uint32_t facing) {
  const double by_area = impl.options.tolerance * impl.clusters.area[slot] / impl.total_area;
  std::uint32_t wanted = 0;
  for (std::size_t l = 0; l < PatchClusters::lanes; ++l) {
    const double area = impl.clusters.area[cluster * PatchClusters::lanes + l];
    const double most = std::min({open.exchange[l], area, impl.clusters.area[slot]});
    const double allowed = visible_by_area * by_area * area + visible_by_value * impl.options.tolerance * most;
    if (open.error[l] > allowed) wanted |= 1U << l;
  }
  wanted &= facing & ~open.straddling;
  if (wanted != 0) refine_exchange(impl.clusters, slot, cluster, wanted, open);
}

/// The lanes of a cluster whose patches belong to the same surface as that of the slot.
std::uint32_t AutoFormFactors::Impl::Worker::same_surface(std::size_t slot, std::size_t cluster) const {
  const std::uint32_t surface = impl.mesh.surface_of[impl.clusters.patch[slot]];
  std::uint32_t same = 0;
  for (std::size_t l = 0; l < PatchClusters::lanes; ++l) {
    if (impl.mesh.surface_of[impl.clusters.patch[cluster * PatchClusters::lanes + l]] == surface) same |= 1U << l;
  }
  return same;
}

void AutoFormFactors::Impl::Worker::patch_row(std::size_t a, std::size_t lane, std::size_t b) {
  const std::size_t slot = a * PatchClusters::lanes + lane;
  far_exchange(impl.clusters, slot, b, impl.coplanar, open);
  std::uint32_t facing = open.facing;
  if (a == b) facing &= surveys || only_lane == lane ? ~(1U << lane) : ~((2U << lane) - 1U);  // each pair once
  if (impl.options.between_surfaces_only) facing &= ~same_surface(slot, b);
  if (facing == 0) return;
  const std::uint32_t in_part = disturbed ? sight.look(lane, facing) : 0;
  if (facing == 0) return;
  if (!surveys) refine_where_needed(slot, b, facing & ~in_part);
  for (std::uint32_t rest = facing; rest != 0; rest &= rest - 1) {
    const auto l = static_cast<std::size_t>(std::countr_zero(rest));
    const std::uint32_t bit = 1U << l;
    if (!surveys) {
      patch_pair(slot, b * PatchClusters::lanes + l, (open.straddling & bit) != 0, (in_part & bit) != 0);
    } else if ((in_part & bit) != 0) {
      const double area = impl.clusters.area[b * PatchClusters::lanes + l];
      // What is not known well may be all that there can be.
      const double most = std::min(area, impl.clusters.area[slot]);
      const double exchange = (open.straddling & bit) != 0 ? most : std::min(open.exchange[l] + open.error[l], most);
      (*surveys)[lane].by_area += area / impl.total_area;
      (*surveys)[lane].by_value += exchange / impl.clusters.area[slot];
      (*surveys)[lane].pairs += 1;
    }
  }
}

void AutoFormFactors::Impl::Worker::cluster_pair(std::size_t a, std::size_t b) {
  const auto& first = impl.clusters.clusters[a];
  const auto& second = impl.clusters.clusters[b];
  const auto behind = [&](const PatchClusters::Cluster& of, const PatchClusters::Cluster& other) {
    return of.flat && std::all_of(other.box.begin(), other.box.end(),
                                  [&](const Vec3d& v) { return of.plane.distance(v) <= impl.coplanar; });
  };
  if (behind(first, second) || behind(second, first)) return;
  const Sight between = sight.begin(a, b);
  if (between == Sight::hidden) return;
  disturbed = between == Sight::partial;
  for (std::size_t lane = 0; lane < first.count; ++lane)
    if (surveys ? lane % impl.survey_step_of_patches() == 0 : only_lane == PatchClusters::lanes || only_lane == lane)
      patch_row(a, lane, b);
}

void AutoFormFactors::Impl::Worker::run(const Block& block) {
  const std::size_t column_end = std::min(block.column + block_columns, impl.clusters.size());
  first_row = block.row * PatchClusters::lanes;
  first_column = block.column * PatchClusters::lanes;
  dropped_rows.assign((block.row_end - block.row) * PatchClusters::lanes, 0.0);
  dropped_columns.assign((column_end - block.column) * PatchClusters::lanes, 0.0);
  for (std::size_t a = block.row; a < block.row_end; ++a)
    for (std::size_t b = std::max(a, block.column); b < column_end; ++b) cluster_pair(a, b);
  const auto report = [&](const std::vector<double>& sums, std::size_t first) {
    for (std::size_t slot = 0; slot < sums.size(); ++slot)
      if (sums[slot] > 0) out.dropped.push_back({impl.clusters.patch[first + slot], sums[slot]});
  };
  report(dropped_rows, first_row);
  report(dropped_columns, first_column);
}

/// All pairs of one patch.
void AutoFormFactors::Impl::Worker::run_row(std::uint32_t patch) {
  const std::size_t a = impl.slot_of[patch] / PatchClusters::lanes;
  only_lane = impl.slot_of[patch] % PatchClusters::lanes;
  first_row = a * PatchClusters::lanes;
  first_column = 0;
  dropped_rows.assign(PatchClusters::lanes, 0.0);
  dropped_columns.assign(impl.clusters.size() * PatchClusters::lanes, 0.0);
  for (std::size_t b = 0; b < impl.clusters.size(); ++b) cluster_pair(a, b);
}

/// Finds the largest part that partly hidden pairs have in some rows, and raises what one of them may err accordingly.
void AutoFormFactors::Impl::survey() {
  const std::size_t count = std::min(clusters.size(), settings.surveyed_clusters);
  std::vector<std::vector<Survey>> rows(count, std::vector<Survey>(PatchClusters::lanes));
  parallel_for(count, 1, [&](std::size_t n, std::size_t) {
    const std::size_t a = n * clusters.size() / count;
    Worker worker(*this);
    worker.surveys = &rows[n];
    for (std::size_t b = 0; b < clusters.size(); ++b) worker.cluster_pair(a, b);
  });
  Survey most{1e-3, 1e-3, 0};
  const auto for_each = [&](auto visit) {
    for (const auto& lanes : rows) std::for_each(lanes.begin(), lanes.end(), visit);
  };
  for_each([&](const Survey& row) {
    most.by_area = std::max(most.by_area, survey_margin * row.by_area);
    most.by_value = std::max(most.by_value, survey_margin * row.by_value);
    most.pairs = std::max(most.pairs, row.pairs);
  });
  // The fewest in a row that has a good part of what the worst row has.
  double pairs = most.pairs;
  for_each([&](const Survey& row) {
    if (row.by_value > 0.25 * most.by_value) pairs = std::min(pairs, row.pairs);
  });
  const double few = std::min(1.0, cautious_pairs / std::max(1.0, pairs));
  caution = few * few;
  partial_by_area_all = partial_by_area / std::min(1.0, most.by_area);
  partial_by_value_all = partial_by_value / std::min(1.0, most.by_value);
}

AutoFormFactors::AutoFormFactors(const PatchMesh& mesh, const FormFactorOptions& options)
    : AutoFormFactors(mesh, options, Settings{}) {}

AutoFormFactors::AutoFormFactors(const PatchMesh& mesh, const FormFactorOptions& options, const Settings& settings) {
  if (!(options.tolerance > 0)) throw std::invalid_argument("auto: the tolerance must be greater than 0");
  impl_ = std::make_unique<Impl>(mesh, options, settings);
}

AutoFormFactors::~AutoFormFactors() = default;

std::size_t AutoFormFactors::block_count() const { return impl_->blocks.size(); }

FactorBlock AutoFormFactors::block(std::size_t index) const {
  assert(index < impl_->blocks.size());
  Impl::Worker worker(*impl_);
  worker.run(impl_->blocks[index]);
  return std::move(worker.out);
}

PatchRow AutoFormFactors::row(std::uint32_t patch) const {
  assert(patch < impl_->mesh.radiating_count);
  Impl::Worker worker(*impl_);
  worker.run_row(patch);
  std::vector<std::pair<std::uint32_t, double>> partners;
  for (const PairFactor& p : worker.out.pairs)
    if (p.exchange > 0) partners.emplace_back(p.i == patch ? p.j : p.i, p.exchange);
  std::sort(partners.begin(), partners.end());
  PatchRow row;
  for (const auto& [partner, exchange] : partners) {
    row.patches.push_back(partner);
    row.exchanges.push_back(exchange);
  }
  return row;
}

}  // namespace penumbra
