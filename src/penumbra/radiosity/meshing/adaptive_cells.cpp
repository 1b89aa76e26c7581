#include "penumbra/radiosity/meshing/adaptive_cells.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "penumbra/math/polygon.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/face_cells.h"

namespace penumbra {
namespace {

/// Corners are looked at this far inside the cell, in parts of the way to its middle, so that each side of a jump sees
/// its own.
constexpr double inset = 1e-3;
/// Cells longer than this for their width are halved across their length whatever the light does.
constexpr double longest_for_width = 6;
/// Of a cell's area: what halving must leave on either side.
constexpr double least_half = 1e-3;
/// Cells that are split at once, between looks at the queue: the same on any number of threads.
constexpr std::size_t round_share = 16;

double brightness(const Vec3d& v) { return std::max({v.x, v.y, v.z}); }
double departure(const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Whether halving across `edge` would make a long cell thinner still.
bool is_longer_than_wide(const AdaptiveCell& cell, std::size_t edge) {
  const std::size_t n = cell.corners.size();
  const double width = length(cell.corners[(edge + 1) % n] - cell.corners[edge]);
  return 2 * polygon_area(cell.corners) > 2 * longest_for_width * width * width;
}

void measure(AdaptiveCell& cell, const LampIrradiance::View& view) {
  if (!view.is_lit()) return;
  const std::size_t n = cell.corners.size();
  const Vec3d centre = polygon_centroid(cell.corners);
  const auto inside = [&](const Vec3d& p) { return p + inset * (centre - p); };
  std::vector<Vec3d> at(n);
  Vec3d mean(0);
  for (std::size_t k = 0; k < n; ++k) {
    at[k] = view.at(inside(cell.corners[k]));
    mean += at[k] / static_cast<double>(n);
    cell.brightest = std::max(cell.brightest, brightness(at[k]));
  }
  std::vector<double> of_edge(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3d middle = 0.5 * (cell.corners[k] + cell.corners[(k + 1) % n]);
    of_edge[k] = departure(view.at(inside(middle)) - 0.5 * (at[k] + at[(k + 1) % n]));
  }
  // Halving across an edge of a quadrilateral cuts its opposite, too.
  if (n == 4) {
    for (std::size_t k = 0; k < 2; ++k) of_edge[k] = of_edge[k + 2] = std::max(of_edge[k], of_edge[k + 2]);
  }
  const double in_middle = departure(view.at(centre) - mean);
  const auto worst = static_cast<std::size_t>(std::max_element(of_edge.begin(), of_edge.end()) - of_edge.begin());
  const double error = std::max(of_edge[worst], in_middle);
  if (error <= cell.error) return;
  cell.error = error;
  if (of_edge[worst] > 0.25 * in_middle && !is_longer_than_wide(cell, worst)) cell.worst_edge = worst;
}

}  // namespace

AdaptiveCells::AdaptiveCells(const PatchMesh& patches, double least_size, double contrast)
    : patches_(patches), least_size_(least_size), contrast_(contrast) {
  for (std::uint32_t p = 0; p < patches.radiating_count; ++p) {
    if (!patches.surfaces[patches.surface_of[p]].back) plates_.push_back({p, none});
  }
  // The patches of a back stand in the order of its front's, right after them.
  std::vector<std::uint32_t> first_of(patches.surface_count(), none);
  for (auto p = static_cast<std::uint32_t>(patches.radiating_count); p-- > 0;) first_of[patches.surface_of[p]] = p;
  plate_of_.assign(patches.patch_count(), 0);
  for (std::uint32_t k = 0; k < plates_.size(); ++k) {
    const std::uint32_t row = patches.surface_of[plates_[k].front];
    plate_of_[plates_[k].front] = k;
    if (row + 1 >= patches.surface_count() || !patches.surfaces[row + 1].back) continue;
    plates_[k].back = first_of[row + 1] + (plates_[k].front - first_of[row]);
    plate_of_[plates_[k].back] = k;
  }
}

void AdaptiveCells::add(std::uint32_t plate, std::vector<Vec3d> corners) {
  const auto number = static_cast<std::uint32_t>(cells_.size());
  cells_.push_back({.plate = plate, .corners = std::move(corners), .origin = number});
  choose_longest_edge(cells_.back());
}

void AdaptiveCells::mark() {
  for (std::uint32_t c = 0; c < cells_.size(); ++c) {
    cells_[c].origin = c;
    cells_[c].error = cells_[c].brightest = 0;
  }
}

void AdaptiveCells::note_brightness(double irradiance) { brightest_ = std::max(brightest_, irradiance); }

void AdaptiveCells::measure(const LampIrradiance& light, std::span<const std::uint32_t> which) {
  parallel_for(which.size(), 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) measure(cells_[which[k]], light);
  });
  for (const std::uint32_t c : which) brightest_ = std::max(brightest_, cells_[c].brightest);
}

void AdaptiveCells::measure(const LampIrradiance& light) {
  std::vector<std::uint32_t> all(cells_.size());
  for (std::uint32_t c = 0; c < all.size(); ++c) all[c] = c;
  measure(light, all);
}

/// What may stand in the light is listed for each cell: little for a small one, so that looking is quick.
void AdaptiveCells::measure(AdaptiveCell& cell, const LampIrradiance& light) const {
  choose_longest_edge(cell);
  penumbra::measure(cell, light.view(cell.corners));
  if (plates_[cell.plate].back == none) return;
  penumbra::measure(cell, light.view(std::vector<Vec3d>(cell.corners.rbegin(), cell.corners.rend())));
}

void AdaptiveCells::choose_longest_edge(AdaptiveCell& cell) const {
  const std::size_t n = cell.corners.size();
  double longest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double edge = length(cell.corners[(k + 1) % n] - cell.corners[k]);
    if (edge > longest * (1 + 1e-9)) {
      longest = edge;
      cell.worst_edge = k;
    }
  }
  cell.can_split = longest >= 2 * least_size_;
}

/// What splitting a cell promises: the square of its error times its area.
double AdaptiveCells::promise(const AdaptiveCell& cell) const {
  const double weight = cell.brightest > standard() ? standard() / cell.brightest : 1;
  const double error = weight * cell.error;
  if (!cell.can_split || error <= contrast_ * standard()) return 0;
  return error * error * polygon_area(cell.corners);
}

void AdaptiveCells::split_largest(std::size_t most) {
  std::priority_queue<std::pair<double, std::uint32_t>> largest;
  const auto offer = [&](std::uint32_t c) {
    if (cells_[c].can_split) largest.emplace(polygon_area(cells_[c].corners), c);
  };
  for (std::uint32_t c = 0; c < cells_.size(); ++c) offer(c);
  while (cells_.size() < most && !largest.empty()) {
    const std::uint32_t c = largest.top().second;
    largest.pop();
    choose_longest_edge(cells_[c]);
    if (!split(c)) continue;
    for (const std::uint32_t half : {c, static_cast<std::uint32_t>(cells_.size() - 1)}) {
      choose_longest_edge(cells_[half]);
      offer(half);
    }
  }
}

bool AdaptiveCells::refine(const LampIrradiance& light, std::size_t most, const Progress& progress) {
  using Entry = std::pair<double, std::uint32_t>;
  const auto less = [](const Entry& a, const Entry& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  };
  std::priority_queue<Entry, std::vector<Entry>, decltype(less)> queue(less);
  for (std::uint32_t c = 0; c < cells_.size(); ++c) queue.emplace(promise(cells_[c]), c);
  const std::size_t begun = cells_.size();
  while (cells_.size() < most && !queue.empty() && queue.top().first > 0) {
    if (progress.stop_requested()) return false;
    const std::size_t round = std::clamp<std::size_t>(cells_.size() / round_share, 1, most - cells_.size());
    std::vector<std::uint32_t> changed;
    for (std::size_t k = 0; k < round && !queue.empty() && queue.top().first > 0; ++k) {
      const std::uint32_t c = queue.top().second;
      queue.pop();
      if (!split(c)) continue;
      changed.push_back(c);
      changed.push_back(static_cast<std::uint32_t>(cells_.size() - 1));
    }
    measure(light, changed);
    for (const std::uint32_t c : changed) queue.emplace(promise(cells_[c]), c);
    progress.tell("elements", static_cast<double>(cells_.size() - begun) /
                                  static_cast<double>(std::max<std::size_t>(1, most - begun)));
  }
  return true;
}

/// Halves a cell; its second half goes to the end.
bool AdaptiveCells::split(std::uint32_t c) {
  std::vector<Vec3d> first, second;
  halve_cell(cells_[c].corners, cells_[c].worst_edge, first, second);
  // A corner in the middle of a straight side may leave one half next to nothing.
  const double least = least_half * polygon_area(cells_[c].corners);
  if (first.size() < 3 || second.size() < 3 || !(std::min(polygon_area(first), polygon_area(second)) > least)) {
    cells_[c].can_split = false;
    return false;
  }
  const std::uint32_t plate = cells_[c].plate, origin = cells_[c].origin;
  cells_[c] = {.plate = plate, .corners = std::move(first), .origin = origin};
  cells_.push_back({.plate = plate, .corners = std::move(second), .origin = origin});
  return true;
}

AdaptiveCells::Elements AdaptiveCells::elements() const {
  std::vector<std::vector<std::uint32_t>> of_plate(plates_.size());
  for (std::uint32_t c = 0; c < cells_.size(); ++c) of_plate[cells_[c].plate].push_back(c);
  Elements out;
  ElementBuilder builder(patches_);
  std::vector<Vec3d> turned;
  for (std::uint32_t p = 0; p < patches_.radiating_count; ++p) {
    const bool back = patches_.surfaces[patches_.surface_of[p]].back;
    for (const std::uint32_t c : of_plate[plate_of_[p]]) {
      const std::vector<Vec3d>& corners = cells_[c].corners;
      if (!(polygon_area(corners) > 0)) continue;
      turned.assign(corners.rbegin(), corners.rend());
      builder.add(p, back ? turned : corners);
      out.parent.push_back(p);
      out.cell.push_back(c);
    }
  }
  out.mesh = std::move(builder).finish();
  return out;
}

}  // namespace penumbra
