#include "penumbra/radiosity/form_factors/ray_cast.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "penumbra/math/polygon.h"
#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"
#include "scenes.h"
#include "svg.h"

namespace penumbra::figures {
namespace {

// Rays from a wall of the L-room, coloured by the patch that they meet.
void draw_rays(const std::filesystem::path& folder) {
  const PatchMesh mesh = model_mesh("l_room.vs3");
  const PatchTracer tracer(mesh);
  Svg svg(640, 430);
  const Polygon extent{{0, 0, 3}, {3, 0, 0}, {3, 1, 0}, {0, 3, 3}, {1, 3, 0}, {3, 0, 3}, {3, 1, 3}};
  const Oblique view(0.5, 0.6, extent, {30, 50}, {430, 360});
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    if (mesh.normals[p].z < -0.5) continue;  // the ceiling
    const bool floor = mesh.normals[p].z > 0.5;
    const bool faces_eye = mesh.normals[p].x > 0.5 || mesh.normals[p].y > 0.5;
    svg.polyline(view(mesh.polygon(p)), {"#999", 0.8, floor ? "#f2f2f2" : faces_eye ? "#f8f8f8" : "", 1, ""}, true);
  }
  const std::uint32_t from = 1;  // the wall at the end of one arm, x = 3
  const auto wall = mesh.polygon(from);
  const Frame frame(mesh.normals[from]);
  for (std::uint32_t k = 0; k < 90; ++k) {
    const Vec2d place = owen_sobol_2d(k, 1), aim = owen_sobol_2d(k, 2);
    const Vec3d start = wall[0] + place.x * (wall[1] - wall[0]) + place.y * (wall[3] - wall[0]);
    const Vec3d direction = frame.to_world(sample_cosine_hemisphere(aim));
    const std::uint32_t met = tracer.first_front(tracer.leave_patch(from, start, direction));
    if (met == PatchTracer::no_patch) continue;
    const Plane3 plane = polygon_plane(mesh.polygon(met));
    const Vec3d end = start - plane.distance(start) / dot(plane.normal, direction) * direction;
    const std::string colour = hue(mesh.surface_of[met]);
    svg.line(view(start), view(end), {colour, 0.8, "", 0.6, ""});
    svg.circle(view(end), 2.2, {"", 0, colour, 1, ""});
    svg.circle(view(start), 1.3, {"", 0, "#222", 1, ""});
  }
  std::vector<Vec2d> rim = view(wall);
  svg.polyline(rim, {"#222", 1.8, "", 1, ""}, true);
  svg.text({20, 24}, "90 rays from one wall of the L-room; dots have the colour of the surface that was met", 13);
  const auto row = RayCaster(mesh).row(from, 1 << 14, 0);
  double y = 120;
  svg.text({470, y - 24}, "from 16,384 rays, ± 3 s.e.", 12);
  std::vector<double> factor(mesh.surface_count(), 0.0), error(mesh.surface_count(), 0.0);
  for (const RayCastFactor& f : row) {
    factor[mesh.surface_of[f.patch]] += f.factor;
    error[mesh.surface_of[f.patch]] += 3 * f.standard_error;
  }
  for (std::size_t s = 0; s < factor.size(); ++s) {
    if (factor[s] == 0) continue;
    svg.circle({476, y - 4}, 5, {"", 0, hue(s), 1, ""});
    svg.text({490, y}, fmt::format("{:<6} {:.4f} ± {:.4f}", mesh.surfaces[s].name, factor[s], error[s]), 12);
    y += 20;
  }
  svg.write(folder / "ray_cast_rays.svg");
}

}  // namespace

void draw_ray_cast(const std::filesystem::path& folder) {
  draw_rays(folder);
  const ReferenceBox box = reference_box();
  const RayCaster caster(box.mesh);
  std::vector<Vec2d> measured, reported;
  for (int power = 8; power <= 18; ++power) {
    double square = 0, said = 0;
    for (std::uint32_t p = 0; p < box.mesh.radiating_count; p += 6) {
      std::vector<double> estimate(box.mesh.radiating_count, 0.0);
      for (const RayCastFactor& f : caster.row(p, 1 << power, 1)) {
        estimate[f.patch] = f.factor;
        said += f.standard_error * f.standard_error;
      }
      for (std::size_t j = 0; j < estimate.size(); ++j) square += std::pow(estimate[j] - box.factors[p][j], 2);
    }
    const double rows = std::ceil(static_cast<double>(box.mesh.radiating_count) / 6);
    measured.emplace_back(1 << power, std::sqrt(square / rows));
    reported.emplace_back(1 << power, std::sqrt(said / rows));
    fmt::print("  2^{:2} rays: root mean square over a row {:.3e}, reported {:.3e}\n", power, measured.back().y,
               reported.back().y);
  }
  Svg svg(720, 380);
  Plot plot(svg, {80, 30}, {330, 290}, {256, 262144, "rays a patch", true, 4, 1},
            {1e-4, 0.1, "sqrt of the sum of squared errors of a row", true, 10, 1});
  plot.curve(measured, hue(0), "measured (truth known to 1e-8)");
  plot.curve(reported, hue(1), "reported standard errors", true);
  plot.slope({256, 0.06}, -0.5, 256, 262144, "");
  svg.text(plot.place({1 << 15, 0.0075}), "slope -0.5", 11, "start", 0, "#666");
  plot.slope({256, 0.02}, -0.62, 256, 262144, "");
  svg.text(plot.place({1 << 11, 0.0023}), "slope -0.62", 11, "end", 0, "#666");
  svg.write(folder / "ray_cast_convergence.svg");
}

}  // namespace penumbra::figures
