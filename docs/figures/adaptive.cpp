#include "penumbra/radiosity/form_factors/adaptive.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <optional>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/bsp_sight.h"
#include "scenes.h"
#include "svg.h"

namespace penumbra::figures {
namespace {

const Polygon blocker{{0.40, 0.30, 0.45}, {0.70, 0.30, 0.45}, {0.70, 0.60, 0.45}, {0.40, 0.60, 0.45}};
const Polygon light{{0.25, 0.35, 0.9}, {0.25, 0.65, 0.9}, {0.65, 0.65, 0.9}, {0.65, 0.35, 0.9}};

// Where the plane through a point and an edge meets the square [0, 1]^2 in z = 0.
std::optional<std::array<Vec3d, 2>> trace(const Vec3d& pole, const Vec3d& a, const Vec3d& b) {
  const Vec3d n = cross(a - pole, b - pole);
  const double offset = dot(n, pole);
  std::vector<Vec3d> found;
  const Polygon square = lower_square();
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3d p = square[k], q = square[(k + 1) % 4];
    const double dp = dot(n, p) - offset, dq = dot(n, q) - offset;
    if ((dp > 0) != (dq > 0)) found.push_back(p + dp / (dp - dq) * (q - p));
  }
  if (found.size() != 2) return std::nullopt;
  return std::array<Vec3d, 2>{found[0], found[1]};
}

// A square below, a square light above, a square plate between: what each point below sees of the light.
void draw_shadow_lines(const std::filesystem::path& folder) {
  const PatchMesh mesh = mesh_of({lower_square(), light}, {blocker});
  const BspTree tree(mesh);
  BspSight sight(tree);
  const std::vector<char> blocks{0, 0, 1};
  constexpr int n = 64;
  Svg svg(700, 430);
  const Vec2d corner(40, 60);
  const double size = 320, cell = size / n;
  double largest = 0;
  std::vector<double> seen;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      seen.push_back(sight.factor({(i + 0.5) / n, (j + 0.5) / n, 0}, {0, 0, 1}, 1, blocks));
      largest = std::max(largest, seen.back());
    }
  }
  constexpr int steps = 40;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double v = std::round(seen[static_cast<std::size_t>(j * n + i)] / largest * steps) / steps;
      svg.pixel(corner + Vec2d(i * cell, size - (j + 1) * cell), {cell, cell}, shade(v));
    }
  }
  svg.flush_pixels();
  const auto place = [&](const Vec3d& p) { return corner + Vec2d(size * p.x, size * (1 - p.y)); };
  for (const bool light_corner : {true, false}) {
    const Polygon& poles = light_corner ? light : blocker;
    const Polygon& edges = light_corner ? blocker : light;
    for (const Vec3d& pole : poles) {
      for (std::size_t k = 0; k < 4; ++k) {
        const auto line = trace(pole, edges[k], edges[(k + 1) % 4]);
        if (line) svg.line(place((*line)[0]), place((*line)[1]), {"#fff", 1.1, "", 0.9, light_corner ? "" : "5 3"});
      }
    }
  }
  for (int k = 0; k < 40; ++k) svg.pixel({380, 372 - 4.0 * k}, {16, 4.2}, shade(k / 39.0));
  svg.flush_pixels();
  svg.text({402, 376}, "0", 12);
  svg.text({402, 220}, fmt::format("{:.3f}", largest), 12);
  svg.text({380, 400}, "factor to what is", 12);
  svg.text({380, 416}, "seen of the light", 12);
  const Oblique view(0.5, 0.35, Polygon{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, light[0], light[1]}, {430, 60},
                     {200, 150});
  svg.polyline(view(lower_square()), {"#333", 1, "#dfe7ef", 1, ""}, true);
  svg.polyline(view(blocker), {"#333", 1, "#999", 0.9, ""}, true);
  svg.polyline(view(light), {"#333", 1, "#f5d97a", 0.9, ""}, true);
  svg.text(view(light[2]) + Vec2d(10, 0), "light", 12);
  svg.text(view(blocker[2]) + Vec2d(10, 2), "plate", 12);
  svg.text(view(Vec3d(1, 0.5, 0)) + Vec2d(0, 18), "receiver", 12, "middle");
  svg.text({20, 24}, "Half-shadow of a plate, and the lines along which the integrand has kinks", 13);
  svg.text({40, 404}, "solid: corner of the light, edge of the plate", 11);
  svg.text({40, 420}, "dashed: edge of the light, corner of the plate", 11);
  svg.write(folder / "adaptive_shadow_lines.svg");
}

double factor_at(const PatchMesh& mesh, double tolerance, AdaptiveVisibility visibility) {
  AdaptiveOptions options;
  options.tolerance = tolerance;
  options.visibility = visibility;
  return assemble_factor_matrix(*make_adaptive(mesh, options), mesh).at(0, 1);
}

}  // namespace

void draw_adaptive(const std::filesystem::path& folder) {
  draw_shadow_lines(folder);
  // A plate 0.01 above the lower of two unit squares: F to 15 digits by an independent semi-analytic computation.
  constexpr double truth = 0.1418679263878689;
  const PatchMesh plate = mesh_of({lower_square(), upper_square(1)},
                                  {{{0.25, 0.25, 0.01}, {0.75, 0.25, 0.01}, {0.75, 0.75, 0.01}, {0.25, 0.75, 0.01}}});
  const ReferenceBox box = reference_box();
  std::vector<Vec2d> cutting, halving, worst, estimated;
  for (int power = 1; power <= 7; ++power) {
    const double tolerance = std::pow(10.0, -power);
    cutting.emplace_back(tolerance,
                         std::max(1e-16, std::abs(factor_at(plate, tolerance, AdaptiveVisibility::clipping) - truth)));
    if (power <= 6)
      halving.emplace_back(
          tolerance, std::max(1e-16, std::abs(factor_at(plate, tolerance, AdaptiveVisibility::bsp_tree) - truth)));
    AdaptiveOptions options;
    options.tolerance = tolerance;
    const RowErrors rows = row_errors(assemble_factor_matrix(*make_adaptive(box.mesh, options), box.mesh), box.factors);
    worst.emplace_back(tolerance, rows.worst);
    estimated.emplace_back(tolerance, rows.estimated);
    fmt::print("  {:.0e} plate, cut {:.2e} halved {:.2e}; box, worst row {:.2e} estimated {:.2e}\n", tolerance,
               cutting.back().y, halving.back().y, rows.worst, rows.estimated);
  }
  Svg svg(760, 380);
  Plot plot(svg, {80, 30}, {330, 290}, {1e-7, 0.1, "tolerance of a row", true, 10, 1},
            {1e-12, 1, "error", true, 10, 2});
  plot.curve(std::array<Vec2d, 2>{Vec2d(1e-7, 1e-7), Vec2d(0.1, 0.1)}, "#999", "error = tolerance", true);
  plot.curve(estimated, hue(1), "box: worst row, estimated");
  plot.curve(worst, hue(3), "box: worst row, true (known to 1e-8)");
  plot.curve(halving, hue(4), "near plate: halving in BSP order");
  plot.curve(cutting, hue(0), "near plate: cut along shadow lines");
  svg.write(folder / "adaptive_convergence.svg");
}

}  // namespace penumbra::figures
