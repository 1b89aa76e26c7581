#include "penumbra/radiosity/form_factors/adaptive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/math/quadrature.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/bsp_sight.h"
#include "penumbra/radiosity/form_factors/bsp_tree.h"
#include "penumbra/radiosity/form_factors/obstructed_exchange.h"
#include "penumbra/radiosity/form_factors/occluder_index.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/shaft.h"

namespace penumbra {
namespace {

constexpr int nodes = 4;                 // of the Gauss rule each way, when halving
constexpr std::size_t fewest_cells = 8;  // before its estimate is believed
// A piece longer than so many times its distance from a blocker may overlook, of what it would see without one:
constexpr double near_blocker = 2, overlooked_near = 0.05;
constexpr double in_plane = 1e-9;  // of the mesh's size: a corner this far in front of a plane lies on it

Bounds bounds_of(std::span<const Vec3d> polygon) {
  Bounds b;
  for (const Vec3d& v : polygon) b.grow(v);
  return b;
}

/// Of two boxes, 0 when they meet.
double distance(const Bounds& a, const Bounds& b) {
  Vec3d gap(0);
  for (int axis = 0; axis < 3; ++axis)
    gap[axis] = std::max({0.0, a.lower[axis] - b.upper[axis], b.lower[axis] - a.upper[axis]});
  return length(gap);
}

bool reaches_front(std::span<const Vec3d> polygon, const Plane3& plane, double tolerance) {
  return std::any_of(polygon.begin(), polygon.end(), [&](const Vec3d& v) { return plane.distance(v) > tolerance; });
}

// Integrates by halving. A piece's error is what cutting it changes and what a smaller rule on its halves would: a
// shadow edge may hide from one of the two. No pair is believed before it was cut into a few pieces, and no piece that
// is long against its distance from a blocker, whose shadow may be as sharp as that.
class Halving {
 public:
  /// @param blockers the bounds of what may be in between. @param open the mean factor to the source without it.
  Halving(BspSight& sight, const std::vector<char>& blocks, const std::vector<Bounds>& blockers, std::uint32_t source,
          const Vec3d& normal, double open)
      : sight_(sight), blocks_(blocks), blockers_(blockers), source_(source), normal_(normal), open_(open) {}

  ExchangeEstimate integrate(std::span<const Vec3d> receiver, double allowed, std::size_t most_cells) {
    std::vector<Cell> cells;  // a heap with the worst on top
    const auto better = [](const Cell& a, const Cell& b) { return a.error < b.error; };
    const auto add = [&](std::vector<Vec3d> polygon) {
      cells.push_back(measure(std::move(polygon)));
      std::push_heap(cells.begin(), cells.end(), better);
      return cells.size();
    };
    add({receiver.begin(), receiver.end()});
    double error = cells.front().error;
    while ((error > allowed || cells.size() < fewest_cells) && cells.size() < most_cells) {
      std::pop_heap(cells.begin(), cells.end(), better);
      const Cell worst = std::move(cells.back());
      cells.pop_back();
      for (const auto& half : worst.halves) {
        if (half.size() >= 3) add(half);
      }
      error = 0;
      for (const Cell& cell : cells) error += cell.error;
    }
    ExchangeEstimate sum;
    for (const Cell& cell : cells) {
      sum.exchange += cell.exchange;
      sum.error += cell.error;
    }
    return sum;
  }

 private:
  struct Cell {
    std::vector<Vec3d> halves[2];
    double exchange = 0;  // of the halves
    double error = 0;
  };

  Cell measure(std::vector<Vec3d> polygon) {
    Cell cell;
    const double whole = rule(polygon, nodes);
    halve(polygon, cell.halves);
    double coarse = 0;
    for (const auto& half : cell.halves) {
      const double fine = rule(half, nodes);
      cell.exchange += fine;
      coarse += std::abs(fine - rule(half, nodes - 1));
    }
    cell.error = std::max(std::abs(cell.exchange - whole), coarse);
    if (is_near_blocker(polygon)) cell.error = std::max(cell.error, overlooked_near * open_ * polygon_area(polygon));
    return cell;
  }

  [[nodiscard]] bool is_near_blocker(std::span<const Vec3d> polygon) const {
    const Bounds bounds = bounds_of(polygon);
    const double size = polygon_size(polygon);
    return std::any_of(blockers_.begin(), blockers_.end(),
                       [&](const Bounds& b) { return size > near_blocker * distance(bounds, b); });
  }

  double rule(std::span<const Vec3d> polygon, int n) {
    if (polygon.size() < 3) return 0;
    polygon_rule(polygon, n, points_);
    double sum = 0;
    for (const WeightedPoint& p : points_) sum += p.weight * sight_.factor(p.point, normal_, source_, blocks_);
    return sum;
  }

  // Across the longest edge's direction, through the centroid.
  static void halve(std::span<const Vec3d> polygon, std::vector<Vec3d> (&halves)[2]) {
    Vec3d longest(0);
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec3d edge = polygon[(k + 1) % polygon.size()] - polygon[k];
      if (length_squared(edge) > length_squared(longest)) longest = edge;
    }
    const Vec3d normal = normalize(longest);
    const Plane3 plane{normal, dot(normal, polygon_centroid(polygon))};
    clip_polygon(polygon, plane, 0, halves[0]);
    clip_polygon(polygon, {-plane.normal, -plane.offset}, 0, halves[1]);
  }

  BspSight& sight_;
  const std::vector<char>& blocks_;
  const std::vector<Bounds>& blockers_;
  std::uint32_t source_;
  Vec3d normal_;
  double open_;
  std::vector<WeightedPoint> points_;
};

class AdaptiveMethod final : public FormFactorMethod {
 public:
  AdaptiveMethod(const PatchMesh& mesh, const AdaptiveOptions& options)
      : mesh_(mesh),
        options_(options),
        occluders_(make_occluder_polygons(mesh, options.visibility == AdaptiveVisibility::clipping)),
        index_(occluders_) {
    if (!(options.tolerance > 0)) throw std::invalid_argument("the tolerance should be positive");
    if (options.visibility == AdaptiveVisibility::bsp_tree) tree_.emplace(mesh);
    Bounds all;
    for (const Vec3d& v : mesh.vertices) all.grow(v);
    tolerance_ = mesh.vertices.empty() ? 0.0 : in_plane * length(all.upper - all.lower);
    for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
      bounds_.push_back(bounds_of(mesh.polygon(p)));
      planes_.push_back({mesh.normals[p], dot(mesh.normals[p], mesh.centroids[p])});
    }
  }

  [[nodiscard]] std::string_view name() const override { return "adaptive"; }
  [[nodiscard]] std::size_t block_count() const override { return mesh_.radiating_count; }
  [[nodiscard]] double block_cost(std::size_t index) const override {
    return static_cast<double>(mesh_.radiating_count - index);
  }
  [[nodiscard]] FactorBlock block(std::size_t index) const override {
    FactorBlock block;
    Workspace work(occluders_);
    if (tree_) work.sight.emplace(*tree_);
    const auto i = static_cast<std::uint32_t>(index);
    for (std::uint32_t j = i + 1; j < mesh_.radiating_count; ++j) {
      if (options_.between_surfaces_only && mesh_.surface_of[i] == mesh_.surface_of[j]) continue;
      const ExchangeEstimate pair = exchange(i, j, work);
      if (pair.exchange > 0) block.pairs.push_back({i, j, pair.exchange, static_cast<float>(pair.error)});
    }
    return block;
  }

 private:
  struct Workspace {
    explicit Workspace(const OccluderPolygons& occluders) : obstructed(occluders) {}
    ObstructedExchange obstructed;
    ExchangeAreaScratch scratch;
    std::optional<BspSight> sight;
    std::vector<std::uint32_t> blockers;
    std::vector<char> blocks;
    std::vector<Bounds> between;
  };

  [[nodiscard]] bool face_each_other(std::uint32_t i, std::uint32_t j) const {
    return reaches_front(mesh_.polygon(j), planes_[i], tolerance_) &&
           reaches_front(mesh_.polygon(i), planes_[j], tolerance_);
  }

  [[nodiscard]] ExchangeEstimate exchange(std::uint32_t i, std::uint32_t j, Workspace& work) const {
    if (!face_each_other(i, j)) return {};
    const Sight sight = list_blockers(i, j, work.blockers);
    if (sight == Sight::hidden) return {};
    const auto a = mesh_.polygon(i), b = mesh_.polygon(j);
    if (sight == Sight::visible) return unobstructed(a, b, work);
    // The smaller polygon is integrated over: it needs fewer pieces.
    const bool from_i = mesh_.areas[i] <= mesh_.areas[j];
    const std::uint32_t receiver = from_i ? i : j, source = from_i ? j : i;
    const double allowed = allowed_error(i, j);
    if (work.sight) return by_order(receiver, source, allowed, work);
    work.obstructed.set_pair(mesh_.polygon(receiver), planes_[receiver], mesh_.polygon(source), planes_[source],
                             work.blockers, unobstructed(a, b, work));
    if (work.obstructed.blocker_count() == 0) return unobstructed(a, b, work);
    return work.obstructed.integrate(allowed, 0, options_.most_cells);
  }

  static ExchangeEstimate unobstructed(std::span<const Vec3d> a, std::span<const Vec3d> b, Workspace& work) {
    const double exact = exchange_area(a, b, work.scratch);
    return {exact, 1e-12 * std::min(polygon_area(a), polygon_area(b))};
  }

  // Evenly among all partners, so that the sum over a row keeps the tolerance.
  [[nodiscard]] double allowed_error(std::uint32_t i, std::uint32_t j) const {
    const double evenly = 1.0 / static_cast<double>(mesh_.radiating_count);
    return options_.tolerance * std::min(mesh_.areas[i], mesh_.areas[j]) * evenly;
  }

  [[nodiscard]] Sight list_blockers(std::uint32_t i, std::uint32_t j, std::vector<std::uint32_t>& found) const {
    found.clear();
    const Shaft shaft(bounds_[i], bounds_[j]);
    for (std::uint32_t k = 0; k < occluders_.size(); ++k) {
      if (shaft.misses(occluders_.bounds[k])) continue;
      const Sight sight = index_.sight(mesh_.polygon(i), mesh_.polygon(j), k);
      if (sight == Sight::hidden) return Sight::hidden;
      if (sight == Sight::partial) found.push_back(k);
    }
    return found.empty() ? Sight::visible : Sight::partial;
  }

  [[nodiscard]] ExchangeEstimate by_order(std::uint32_t receiver, std::uint32_t source, double allowed,
                                          Workspace& work) const {
    const Shaft shaft(bounds_[receiver], bounds_[source]);
    work.blocks.assign(mesh_.patch_count(), 0);
    work.between.clear();
    for (std::uint32_t p = 0; p < mesh_.patch_count(); ++p) {
      const bool between = p != receiver && p != source && !shaft.misses(bounds_[p]) &&
                           reaches_front(mesh_.polygon(p), planes_[receiver], tolerance_) &&
                           reaches_front(mesh_.polygon(p), planes_[source], tolerance_);
      work.blocks[p] = between ? 1 : 0;
      if (between && !touches(p, receiver)) work.between.push_back(bounds_[p]);
    }
    std::vector<Vec3d> visible_part;
    clip_polygon(mesh_.polygon(receiver), planes_[source], 0, visible_part);
    if (visible_part.size() < 3) return {};
    const double open = unobstructed(mesh_.polygon(receiver), mesh_.polygon(source), work).exchange;
    return Halving(*work.sight, work.blocks, work.between, source, mesh_.normals[receiver],
                   open / mesh_.areas[receiver])
        .integrate(visible_part, allowed, options_.most_cells);
  }

  /// Whether a patch stands on another's plane: its shadow begins there and widens.
  [[nodiscard]] bool touches(std::uint32_t patch, std::uint32_t other) const {
    const auto polygon = mesh_.polygon(patch);
    return std::any_of(polygon.begin(), polygon.end(),
                       [&](const Vec3d& v) { return std::abs(planes_[other].distance(v)) <= tolerance_; });
  }

  const PatchMesh& mesh_;
  AdaptiveOptions options_;
  OccluderPolygons occluders_;
  OccluderIndex index_;
  std::optional<BspTree> tree_;
  std::vector<Bounds> bounds_;
  std::vector<Plane3> planes_;
  double tolerance_ = 0;
};

}  // namespace

std::unique_ptr<FormFactorMethod> make_adaptive(const PatchMesh& mesh, const AdaptiveOptions& options) {
  return std::make_unique<AdaptiveMethod>(mesh, options);
}

}  // namespace penumbra
