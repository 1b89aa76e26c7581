#include "penumbra/radiosity/meshing/adaptive_elements.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "penumbra/math/bounds.h"
#include "penumbra/radiosity/meshing/adaptive_cells.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/face_cells.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/polygon_division.h"
#include "penumbra/radiosity/meshing/shadow_lines.h"
#include "penumbra/radiosity/meshing/uniform.h"

namespace penumbra {
namespace {

/// Parts of the scene's size: the shortest edge of an element unless the options say.
constexpr double shortest_edge = 1.0 / 2000;

/// The input polygons, with what their textures reflect and emit on average.
MadePatchMesh painted_faces(const Scene& scene, const AdaptiveMeshingOptions& options) {
  MadePatchMesh made = make_element_faces(scene, options.sides, options.shape_segments);
  paint_elements(scene, options.shape_segments, made.mesh);
  return made;
}

double least_size(const PatchMesh& faces, const AdaptiveMeshingOptions& options) {
  if (options.least_size > 0) return options.least_size;
  Bounds all;
  for (const Vec3d& v : faces.vertices) all.grow(v);
  return faces.vertices.empty() ? shortest_edge : shortest_edge * length(all.upper - all.lower);
}

class AdaptiveMesher {
 public:
  AdaptiveMesher(const Scene& scene, const AdaptiveMeshingOptions& options)
      : scene_(scene),
        options_(options),
        made_(painted_faces(scene, options)),
        faces_(made_.mesh),
        light_(scene, faces_),
        cells_(faces_, least_size(faces_, options), options.contrast),
        budget_(options.element_count / (options.sides == PatchSides::both ? 2 : 1)) {}

  AdaptiveMesh mesh() {
    AdaptiveMesh out;
    std::vector<FaceCells> begun = cells_to_begin_with();
    if (options_.shadow_lines) out.shadow_lines = cut_along_shadow_lines(begun);
    for (std::uint32_t k = 0; k < begun.size(); ++k) {
      for (const FaceCells::Cell& corners : begun[k].cells()) cells_.add(k, corners);
    }
    if (cells_.cells().size() < budget_) cells_.measure(light_);
    out.partial = !cells_.refine(light_, budget_, options_.progress);
    // The elements that direct light does not ask for serve the light between surfaces.
    if (!out.partial) cells_.split_largest(budget_);
    AdaptiveCells::Elements made = cells_.elements();
    out.elements = std::move(made.mesh);
    out.parent = std::move(made.parent);
    paint_elements(scene_, options_.shape_segments, out.elements);
    out.patches = std::move(made_.mesh);
    out.warnings = std::move(made_.warnings);
    return out;
  }

 private:
  [[nodiscard]] std::vector<FaceCells> cells_to_begin_with() const {
    const bool dark = light_.lamps().empty();
    const std::size_t evenly = std::max<std::size_t>(1, dark ? options_.element_count : options_.element_count / 8);
    const double size = options_.element_size > 0 ? options_.element_size : size_for_count(faces_, evenly);
    std::vector<FaceCells> all;
    for (const AdaptiveCells::Plate& plate : cells_.plates()) {
      std::vector<FaceCells::Cell> cells;
      divide_polygon(faces_.polygon(plate.front), size,
                     [&](std::span<const Vec3d> cell) { cells.emplace_back(cell.begin(), cell.end()); });
      all.emplace_back(std::move(cells));
    }
    return all;
  }

  /// Lines that jump first, then the longest: when the cells run out the lesser ones are left.
  std::size_t cut_along_shadow_lines(std::vector<FaceCells>& cells) const {
    const std::vector<ShadowLine> lines = by_importance(find_shadow_lines(light_));
    std::size_t count = 0;
    for (const FaceCells& c : cells) count += c.cells().size();
    for (const ShadowLine& line : lines) {
      if (count >= budget_ / 2) break;
      count += cells[cells_.plate_of(line.patch)].cut_along(line.ends[0], line.ends[1], faces_.normals[line.patch],
                                                            cells_.least_size());
    }
    return lines.size();
  }

  const Scene& scene_;
  const AdaptiveMeshingOptions& options_;
  MadePatchMesh made_;
  const PatchMesh& faces_;
  LampIrradiance light_;
  AdaptiveCells cells_;
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
