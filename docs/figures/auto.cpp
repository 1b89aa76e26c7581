#include "penumbra/radiosity/form_factors/auto.h"

#include <fmt/core.h>

#include <array>
#include <chrono>
#include <cmath>

#include "penumbra/radiosity/form_factors/analytic.h"
#include "scenes.h"
#include "svg.h"

namespace penumbra::figures {
namespace {

// The L-room in squares, as seen by one patch: which patches it sees whole, in part, not at all.
void draw_classes(const std::filesystem::path& folder) {
  const PatchMesh coarse = model_mesh("l_room.vs3");
  std::vector<Polygon> parts;
  for (std::uint32_t p = 0; p < coarse.patch_count(); ++p) {
    const auto polygon = coarse.polygon(p);
    const Polygon whole(polygon.begin(), polygon.end());
    const double u = length(whole[1] - whole[0]), v = length(whole[3] - whole[0]);
    const int nu = static_cast<int>(std::lround(4 * u)), nv = static_cast<int>(std::lround(4 * v));
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        const Vec3d du = (whole[1] - whole[0]) / static_cast<double>(nu),
                    dv = (whole[3] - whole[0]) / static_cast<double>(nv);
        const Vec3d at = whole[0] + static_cast<double>(i) * du + static_cast<double>(j) * dv;
        parts.push_back({at, at + du, at + du + dv, at + dv});
      }
    }
  }
  const PatchMesh mesh = mesh_of(parts);
  FormFactorOptions options;
  options.tolerance = 1e-6;
  const AutoFormFactors method(mesh, options);
  // A floor patch in one arm.
  std::uint32_t from = 0;
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    if (mesh.normals[p].z > 0.5 && length(mesh.centroids[p] - Vec3d(0.375, 2.375, 0)) < 0.01) from = p;
  }
  std::vector<double> exchange(mesh.patch_count(), 0.0);
  visit_factors(method, [&](const FactorBlock& block) {
    for (const PairFactor& p : block.pairs) {
      if (p.i == from) exchange[p.j] += p.exchange;
      if (p.j == from) exchange[p.i] += p.exchange;
    }
  });
  Svg svg(700, 430);
  const Polygon extent{{0, 0, 3}, {3, 0, 0}, {3, 1, 0}, {0, 3, 3}, {1, 3, 0}, {3, 0, 3}};
  const Oblique view(0.6, 0.75, extent, {30, 60}, {420, 350});
  std::array<int, 3> counts{};
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const double open = p == from ? 0.0 : exchange_area(mesh.polygon(from), mesh.polygon(p));
    std::string fill = "#ffffff";
    if (open > 0) {
      const double share = exchange[p] / open;
      const bool hidden = share < 1e-9, whole = std::abs(share - 1) < 1e-4;
      ++counts[hidden ? 2 : whole ? 0 : 1];
      fill = hidden ? "#5a6472" : whole ? "#f7dd8b" : "#e07b39";
    }
    if (p == from) fill = "#2c7fb8";
    if (mesh.normals[p].z < -0.5) continue;
    // Walls that turn their backs to the eye would cover the room.
    if (mesh.normals[p].x < -0.5 || mesh.normals[p].y < -0.5) continue;
    svg.polyline(view(mesh.polygon(p)), {"#888", 0.5, fill, 1, ""}, true);
  }
  const std::array<Vec3d, 6> plan{{{0, 0, 3}, {3, 0, 3}, {3, 1, 3}, {1, 1, 3}, {1, 3, 3}, {0, 3, 3}}};
  svg.polyline(view(plan), {"#bbb", 0.8, "", 1, "3 3"}, true);
  svg.text({20, 24},
           fmt::format("The L-room in {} squares, seen from the blue one (ceiling and nearer walls not drawn)",
                       parts.size()),
           13);
  const std::array<const char*, 3> names{"sees whole: no visibility work", "sees in part: shadows cut exactly",
                                         "hidden: costs nothing"};
  const std::array<const char*, 3> colours{"#f7dd8b", "#e07b39", "#5a6472"};
  for (std::size_t k = 0; k < 3; ++k) {
    const double y = 90 + 24 * static_cast<double>(k);
    svg.pixel({410, y - 11}, {14, 14}, colours[k]);
    svg.flush_pixels();
    svg.text({430, y}, fmt::format("{} ({})", names[k], counts[k]), 12);
  }
  svg.write(folder / "auto_classes.svg");
  fmt::print("  {} patches; from one: {} whole, {} in part, {} hidden\n", mesh.patch_count(), counts[0], counts[1],
             counts[2]);
}

}  // namespace

void draw_auto(const std::filesystem::path& folder) {
  draw_classes(folder);
  const ReferenceBox box = reference_box();
  std::vector<Vec2d> worst, estimated, mean;
  for (int power = 1; power <= 7; ++power) {
    FormFactorOptions options;
    options.tolerance = std::pow(10.0, -power);
    const auto start = std::chrono::steady_clock::now();
    const FactorMatrix m = assemble_factor_matrix(AutoFormFactors(box.mesh, options), box.mesh);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const RowErrors rows = row_errors(m, box.factors);
    worst.emplace_back(options.tolerance, rows.worst);
    mean.emplace_back(options.tolerance, rows.mean);
    estimated.emplace_back(options.tolerance, rows.estimated);
    fmt::print("  {:.0e}: {:.3f} s, worst row {:.2e}, mean {:.2e}, estimated {:.2e}\n", options.tolerance, seconds,
               rows.worst, rows.mean, rows.estimated);
  }
  Svg svg(720, 380);
  Plot plot(svg, {80, 30}, {330, 290}, {1e-7, 0.1, "tolerance of a row", true, 10, 1},
            {1e-9, 0.1, "sum over a row of |error|", true, 10, 1});
  plot.curve(std::array<Vec2d, 2>{Vec2d(1e-7, 1e-7), Vec2d(0.1, 0.1)}, "#999", "error = tolerance", true);
  plot.curve(estimated, hue(1), "worst row, estimated");
  plot.curve(worst, hue(3), "worst row, true");
  plot.curve(mean, hue(0), "mean row, true");
  svg.write(folder / "auto_convergence.svg");
}

}  // namespace penumbra::figures
