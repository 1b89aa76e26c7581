#include "penumbra/radiosity/meshing/uniform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/polygon_division.h"

namespace penumbra {
namespace {

/// Beyond this a size is taken for a mistake of units.
constexpr double most_elements = 1e8;

void check(const MeshingOptions& options) {
  if (!(options.element_size >= 0)) {
    throw std::invalid_argument("The element size must be 0 or more metres.");
  }
}

double count_elements(const PatchMesh& faces, double size) {
  double count = 0;
  for (std::size_t p = 0; p < faces.radiating_count; ++p) {
    count += static_cast<double>(count_cells(faces.polygon(p), size));
    if (count > 2 * most_elements) break;
  }
  return count;
}

}  // namespace

double size_for_count(const PatchMesh& faces, std::size_t wanted) {
  double area = 0, longest = 0;
  for (std::size_t p = 0; p < faces.radiating_count; ++p) {
    area += faces.areas[p];
    longest = std::max(longest, polygon_size(faces.polygon(p)));
  }
  const auto target = static_cast<double>(wanted);
  double low = std::min(longest, 0.3 * std::sqrt(area / target)), high = longest, best = longest;
  if (!(low > 0)) return 0;
  double nearest = std::abs(count_elements(faces, longest) - target);
  for (int step = 0; step < 40 && high > low * (1 + 1e-7); ++step) {
    const double middle = std::sqrt(low * high), count = count_elements(faces, middle);
    if (std::abs(count - target) < nearest) {
      nearest = std::abs(count - target);
      best = middle;
    }
    (count > target ? low : high) = middle;
  }
  return best;
}

namespace {

double element_size(const PatchMesh& faces, const MeshingOptions& options) {
  const bool by_count = options.element_size == 0 && options.element_count > 0;
  if (by_count && static_cast<double>(options.element_count) > most_elements) {
    throw std::invalid_argument(
        fmt::format("{} elements are more than this program handles ({:.0f}).", options.element_count, most_elements));
  }
  const double size = by_count ? size_for_count(faces, options.element_count) : options.element_size;
  if (count_elements(faces, size) > most_elements) {
    throw std::invalid_argument(
        fmt::format("Elements of {} m would be more than {:.0f}: choose a larger size, or check the scene's unit.",
                    size, most_elements));
  }
  return size;
}

}  // namespace

MadePatchMesh make_uniform_elements(const Scene& scene, const MeshingOptions& options) {
  check(options);
  MadePatchMesh coarse = make_element_faces(scene, options.sides, options.shape_segments);
  const double size = element_size(coarse.mesh, options);
  ElementBuilder builder(coarse.mesh);
  for (std::uint32_t p = 0; p < coarse.mesh.radiating_count; ++p) {
    divide_polygon(coarse.mesh.polygon(p), size, [&](std::span<const Vec3d> cell) {
      if (polygon_area(cell) > 0) builder.add(p, cell);  // the tip of a sliver may have no width that a double can hold
    });
  }
  PatchMesh elements = std::move(builder).finish();
  paint_elements(scene, options.shape_segments, elements);
  return {std::move(elements), std::move(coarse.warnings)};
}

}  // namespace penumbra
