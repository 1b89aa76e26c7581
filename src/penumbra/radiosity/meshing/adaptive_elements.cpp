#include "penumbra/radiosity/meshing/adaptive_elements.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>
#include <utility>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/face_cells.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/polygon_division.h"
#include "penumbra/radiosity/meshing/shadow_lines.h"
#include "penumbra/radiosity/meshing/uniform.h"

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

/// The input polygons, with what their textures reflect and emit on average.
MadePatchMesh painted_faces(const Scene& scene, const AdaptiveMeshingOptions& options) {
  MadePatchMesh made = make_element_faces(scene, options.sides, options.shape_segments);
  paint_elements(scene, options.shape_segments, made.mesh);
  return made;
}

/// A cell of a face with what its interpolation misses.
struct Cell {
  std::uint32_t plate = 0;
  std::vector<Vec3d> corners;
  double error = 0;            // W/m^2, largest over middle and edges
  double brightest = 0;        // W/m^2
  std::size_t worst_edge = 0;  // whose middle departs most, or the longest where none does
  bool can_split = true;
};

/// A front and, where both sides count, its back.
struct Plate {
  std::uint32_t front = 0;
  std::uint32_t back = 0xffffffffU;
};

class AdaptiveMesher {
 public:
  AdaptiveMesher(const Scene& scene, const AdaptiveMeshingOptions& options)
      : scene_(scene),
        options_(options),
        made_(painted_faces(scene, options)),
        faces_(made_.mesh),
        light_(scene, faces_) {
    Bounds all;
    for (const Vec3d& v : faces_.vertices) all.grow(v);
    const double size = faces_.vertices.empty() ? 1 : length(all.upper - all.lower);
    least_size_ = options.least_size > 0 ? options.least_size : size / 2000;
    make_plates();
    budget_ = options.element_count / (options.sides == PatchSides::both ? 2 : 1);
  }

  AdaptiveMesh mesh() {
    AdaptiveMesh out;
    std::vector<FaceCells> cells = cells_to_begin_with();
    if (options_.shadow_lines) out.shadow_lines = cut_along_shadow_lines(cells);
    collect(cells);
    refine(out.partial);
    if (!out.partial) spend_the_rest();
    build(out);
    return out;
  }

 private:
  void make_plates() {
    for (std::uint32_t p = 0; p < faces_.radiating_count; ++p) {
      if (!faces_.surfaces[faces_.surface_of[p]].back) plates_.push_back({p, 0xffffffffU});
    }
    // The patches of a back stand in the order of its front's, right after them.
    std::vector<std::uint32_t> first_of(faces_.surface_count(), 0xffffffffU);
    for (std::uint32_t p = static_cast<std::uint32_t>(faces_.radiating_count); p-- > 0;) {
      first_of[faces_.surface_of[p]] = p;
    }
    plate_of_.assign(faces_.patch_count(), 0);
    for (std::uint32_t k = 0; k < plates_.size(); ++k) {
      const std::uint32_t row = faces_.surface_of[plates_[k].front];
      plate_of_[plates_[k].front] = k;
      if (row + 1 >= faces_.surface_count() || !faces_.surfaces[row + 1].back) continue;
      plates_[k].back = first_of[row + 1] + (plates_[k].front - first_of[row]);
      plate_of_[plates_[k].back] = k;
    }
  }

  [[nodiscard]] std::vector<FaceCells> cells_to_begin_with() const {
    const bool dark = light_.lamps().empty();
    const std::size_t evenly = std::max<std::size_t>(1, dark ? options_.element_count : options_.element_count / 8);
    const double size = options_.element_size > 0 ? options_.element_size : size_for_count(faces_, evenly);
    std::vector<FaceCells> all;
    for (const Plate& plate : plates_) {
      std::vector<FaceCells::Cell> cells;
      divide_polygon(faces_.polygon(plate.front), size,
                     [&](std::span<const Vec3d> cell) { cells.emplace_back(cell.begin(), cell.end()); });
      all.emplace_back(std::move(cells));
    }
    return all;
  }

  /// Lines that jump first, then the longest: when the cells run out the lesser ones are left.
  std::size_t cut_along_shadow_lines(std::vector<FaceCells>& cells) const {
    std::vector<ShadowLine> lines = find_shadow_lines(light_);
    std::stable_sort(lines.begin(), lines.end(), [](const ShadowLine& a, const ShadowLine& b) {
      if (a.degree != b.degree) return a.degree < b.degree;
      return length_squared(a.ends[1] - a.ends[0]) > length_squared(b.ends[1] - b.ends[0]);
    });
    std::size_t count = 0;
    for (const FaceCells& c : cells) count += c.cells().size();
    for (const ShadowLine& line : lines) {
      if (count >= budget_ / 2) break;
      count +=
          cells[plate_of_[line.patch]].cut_along(line.ends[0], line.ends[1], faces_.normals[line.patch], least_size_);
    }
    return lines.size();
  }

  void collect(const std::vector<FaceCells>& cells) {
    for (std::uint32_t k = 0; k < plates_.size(); ++k) {
      for (const FaceCells::Cell& corners : cells[k].cells()) cells_.push_back({k, corners});
    }
    if (cells_.size() < budget_) measure(0);
  }

  /// Looks at the irradiance of all cells from number `first` on.
  void measure(std::size_t first) {
    parallel_for(cells_.size() - first, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = first + begin; c < first + end; ++c) measure(cells_[c]);
    });
    for (std::size_t c = first; c < cells_.size(); ++c) brightest_ = std::max(brightest_, cells_[c].brightest);
  }

  /// What may stand in the light is listed for each cell: little for a small one, so that looking is quick.
  void measure(Cell& cell) const {
    choose_longest_edge(cell);
    measure(cell, light_.view(cell.corners));
    if (plates_[cell.plate].back == 0xffffffffU) return;
    measure(cell, light_.view(std::vector<Vec3d>(cell.corners.rbegin(), cell.corners.rend())));
  }

  void choose_longest_edge(Cell& cell) const {
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

  static void measure(Cell& cell, const LampIrradiance::View& view) {
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
    const std::size_t worst =
        static_cast<std::size_t>(std::max_element(of_edge.begin(), of_edge.end()) - of_edge.begin());
    const double error = std::max(of_edge[worst], in_middle);
    if (error <= cell.error) return;
    cell.error = error;
    if (of_edge[worst] > 0.25 * in_middle && !is_longer_than_wide(cell, worst)) cell.worst_edge = worst;
  }

  /// Whether halving across `edge` would make a long cell thinner still.
  static bool is_longer_than_wide(const Cell& cell, std::size_t edge) {
    const std::size_t n = cell.corners.size();
    const double width = length(cell.corners[(edge + 1) % n] - cell.corners[edge]);
    return 2 * polygon_area(cell.corners) > 2 * longest_for_width * width * width;
  }

  /// What splitting a cell promises: the square of its error times its area.
  [[nodiscard]] double promise(const Cell& cell) const {
    if (!cell.can_split || cell.error <= options_.contrast * brightest_) return 0;
    return cell.error * cell.error * polygon_area(cell.corners);
  }

  /// The elements that direct light does not ask for serve the light between surfaces: the largest cells are split.
  void spend_the_rest() {
    using Entry = std::pair<double, std::uint32_t>;
    std::priority_queue<Entry> largest;
    const auto offer = [&](std::uint32_t c) {
      if (cells_[c].can_split) largest.emplace(polygon_area(cells_[c].corners), c);
    };
    for (std::uint32_t c = 0; c < cells_.size(); ++c) offer(c);
    while (cells_.size() < budget_ && !largest.empty()) {
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

  void refine(bool& stopped) {
    using Entry = std::pair<double, std::uint32_t>;
    const auto less = [](const Entry& a, const Entry& b) {
      return a.first != b.first ? a.first < b.first : a.second > b.second;
    };
    std::priority_queue<Entry, std::vector<Entry>, decltype(less)> queue(less);
    for (std::uint32_t c = 0; c < cells_.size(); ++c) queue.emplace(promise(cells_[c]), c);
    const std::size_t begun = cells_.size();
    while (cells_.size() < budget_ && !queue.empty() && queue.top().first > 0) {
      if (options_.progress.stop_requested()) {
        stopped = true;
        return;
      }
      const std::size_t round = std::clamp<std::size_t>(cells_.size() / round_share, 1, budget_ - cells_.size());
      const std::size_t first_new = cells_.size();
      std::vector<std::uint32_t> changed;
      for (std::size_t k = 0; k < round && !queue.empty() && queue.top().first > 0; ++k) {
        const std::uint32_t c = queue.top().second;
        queue.pop();
        if (split(c)) changed.push_back(c);
      }
      parallel_for(changed.size(), 4, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) measure(cells_[changed[k]]);
      });
      measure(first_new);
      for (const std::uint32_t c : changed) queue.emplace(promise(cells_[c]), c);
      for (std::size_t c = first_new; c < cells_.size(); ++c) {
        queue.emplace(promise(cells_[c]), static_cast<std::uint32_t>(c));
      }
      options_.progress.tell("elements", static_cast<double>(cells_.size() - begun) /
                                             static_cast<double>(std::max<std::size_t>(1, budget_ - begun)));
    }
  }

  /// Halves a cell; its second half goes to the end.
  bool split(std::uint32_t c) {
    std::vector<Vec3d> first, second;
    halve_cell(cells_[c].corners, cells_[c].worst_edge, first, second);
    // A corner in the middle of a straight side may leave one half next to nothing.
    const double least = least_half * polygon_area(cells_[c].corners);
    if (first.size() < 3 || second.size() < 3 || !(std::min(polygon_area(first), polygon_area(second)) > least)) {
      cells_[c].can_split = false;
      return false;
    }
    const std::uint32_t plate = cells_[c].plate;
    cells_[c] = {plate, std::move(first)};
    cells_.push_back({plate, std::move(second)});
    return true;
  }

  void build(AdaptiveMesh& out) {
    std::vector<std::vector<std::uint32_t>> of_plate(plates_.size());
    for (std::uint32_t c = 0; c < cells_.size(); ++c) of_plate[cells_[c].plate].push_back(c);
    ElementBuilder builder(faces_);
    std::vector<Vec3d> turned;
    for (std::uint32_t p = 0; p < faces_.radiating_count; ++p) {
      const bool back = faces_.surfaces[faces_.surface_of[p]].back;
      for (const std::uint32_t c : of_plate[plate_of_[p]]) {
        const std::vector<Vec3d>& corners = cells_[c].corners;
        if (!(polygon_area(corners) > 0)) continue;
        turned.assign(corners.rbegin(), corners.rend());
        builder.add(p, back ? turned : corners);
        out.parent.push_back(p);
      }
    }
    out.elements = std::move(builder).finish();
    paint_elements(scene_, options_.shape_segments, out.elements);
    out.patches = std::move(made_.mesh);
    out.warnings = std::move(made_.warnings);
  }

  const Scene& scene_;
  const AdaptiveMeshingOptions& options_;
  MadePatchMesh made_;
  const PatchMesh& faces_;
  LampIrradiance light_;
  std::vector<Plate> plates_;
  std::vector<std::uint32_t> plate_of_;
  std::vector<Cell> cells_;
  double brightest_ = 0;
  double least_size_ = 0;
  std::size_t budget_ = 0;
};

}  // namespace

AdaptiveMesh make_adaptive_elements(const Scene& scene, const AdaptiveMeshingOptions& options) {
  if (options.element_count < 1 || !(options.contrast >= 0) || !(options.element_size >= 0) ||
      !(options.least_size >= 0)) {
    throw std::invalid_argument("Adaptive elements need a count of at least 1, and sizes and a contrast of 0 or more.");
  }
  return AdaptiveMesher(scene, options).mesh();
}

}  // namespace penumbra
