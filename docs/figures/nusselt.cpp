#include "penumbra/radiosity/form_factors/nusselt.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "scenes.h"
#include "svg.h"

namespace penumbra::figures {
namespace {

// A polygon's outline with `parts` points an edge.
Polygon fine_outline(const Polygon& p, int parts) {
  Polygon out;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec3d d = p[(k + 1) % p.size()] - p[k];
    for (int i = 0; i < parts; ++i) out.push_back(p[k] + (static_cast<double>(i) / parts) * d);
  }
  return out;
}

Polygon circle(const Vec3d& u, const Vec3d& v, double from, double to) {
  Polygon out;
  for (int k = 0; k <= 64; ++k) {
    const double a = from + (to - from) * k / 64;
    out.push_back(std::cos(a) * u + std::sin(a) * v);
  }
  return out;
}

void draw_projection(const std::filesystem::path& folder) {
  Svg svg(640, 470);
  const double pi = std::numbers::pi;
  const Polygon extent{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {0, 0, 1.3}, {-0.9, 2.0, 0.9}, {-0.9, 1.5, 1.5}};
  const Oblique view(0.5, 0.42, extent, {20, 60}, {600, 330});
  const Vec3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  svg.polyline(view(circle(x, y, 0, 2 * pi)), {"#888", 1, "#f3f3f3", 1, ""}, true);
  const Polygon patch{{-0.1, 1.0, 1.1}, {-0.9, 1.5, 1.5}, {-0.9, 2.0, 0.9}, {-0.1, 1.5, 0.5}};
  Polygon on_sphere, on_disk;
  for (const Vec3d& p : fine_outline(patch, 24)) {
    on_sphere.push_back(normalize(p));
    on_disk.push_back({on_sphere.back().x, on_sphere.back().y, 0});
  }
  svg.polyline(view(on_disk), {"#a33", 1.2, hue(3), 0.85, ""}, true);
  for (const double a : {0.0, pi / 3, 2 * pi / 3}) {
    svg.polyline(view(circle(std::cos(a) * x + std::sin(a) * y, z, 0, pi)), {"#bbb", 0.8, "", 1, ""});
  }
  for (const double h : {0.4, 0.75}) {
    const double r = std::sqrt(1 - h * h);
    Polygon ring = circle(r * x, r * y, 0, 2 * pi);
    for (Vec3d& p : ring) p.z = h;
    svg.polyline(view(ring), {"#ccc", 0.7, "", 1, ""}, true);
  }
  svg.polyline(view(on_sphere), {"#b06a10", 1.2, hue(1), 0.75, ""}, true);
  svg.polyline(view(patch), {"#2c5a86", 1.4, hue(0), 0.75, ""}, true);
  for (std::size_t k = 0; k < 4; ++k) {
    svg.line(view(Vec3d(0)), view(patch[k]), {"#555", 0.8, "", 1, "3 3"});
    svg.line(view(on_sphere[24 * k]), view(on_disk[24 * k]), {"#a33", 0.9, "", 1, "2 2"});
  }
  svg.circle(view(Vec3d(0)), 3.5, {"", 0, "#222", 1, ""});
  svg.arrow(view(Vec3d(0)), view(Vec3d(0, 0, 1.3)), {"#222", 1.4, "", 1, ""});
  svg.text(view(Vec3d(0, 0, 1.3)) + Vec2d(-8, 4), "n", 14, "end");
  const double f = point_to_polygon(Vec3d(0), z, patch);
  const double f_on_disk = polygon_area(on_disk) / pi;
  svg.text({20, 24}, "A patch, its image on the unit sphere, and the shadow of that image on the disk", 13);
  svg.text({20, 432}, fmt::format("shadow / disk = {:.5f} (drawn outline)", f_on_disk), 13);
  svg.text({20, 454}, fmt::format("Lambert's edge sum = {:.5f}", f), 13);
  svg.text(view(patch[1]) + Vec2d(0, -8), "patch", 13, "middle", 0, "#2c5a86");
  svg.write(folder / "nusselt_projection.svg");
  fmt::print("  shadow {:.8f} Lambert {:.8f}\n", f_on_disk, f);
}

double from_centres(const std::vector<Polygon>& from, const Polygon& to) {
  double sum = 0;
  for (const Polygon& p : from) sum += point_to_polygon(polygon_centroid(p), polygon_normal(p), to);
  return sum / static_cast<double>(from.size());
}

}  // namespace

void draw_nusselt(const std::filesystem::path& folder) {
  draw_projection(folder);
  Svg svg(700, 380);
  Plot plot(svg, {80, 30}, {330, 290}, {1, 64, "n: parts along a side, one element in each", true, 2, 1},
            {1e-6, 1, "relative error", true, 10, 1});
  std::vector<Vec2d> near, facing, touching;
  for (int n = 1; n <= 64; n *= 2) {
    const auto parts = subdivided(lower_square(), n);
    const auto error = [&](const Polygon& to) {
      return std::abs(from_centres(parts, to) / polygon_to_polygon(lower_square(), to) - 1);
    };
    touching.emplace_back(n, error(standing_square()));
    near.emplace_back(n, error(upper_square(0.1)));
    facing.emplace_back(n, error(upper_square(1)));
    fmt::print("  {:3} touching {:.3e} near {:.3e} facing {:.3e}\n", n, touching.back().y, near.back().y,
               facing.back().y);
  }
  plot.curve(touching, hue(3), "squares that share an edge");
  plot.curve(near, hue(1), "facing at 0.1 sides");
  plot.curve(facing, hue(0), "facing at 1 side");
  plot.slope({4, 6e-3}, -2, 4, 64, "");
  svg.text(plot.place({34, 1.4e-4}), "slope -2", 11, "start", 0, "#666");
  svg.write(folder / "nusselt_convergence.svg");
}

}  // namespace penumbra::figures
