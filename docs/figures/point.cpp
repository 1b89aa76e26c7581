#include "penumbra/radiosity/form_factors/point.h"

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "scenes.h"
#include "svg.h"

namespace penumbra::figures {
namespace {

double by_points(const std::vector<Polygon>& from, const std::vector<Polygon>& to) {
  double exchange = 0, area = 0;
  for (const Polygon& a : from) {
    area += polygon_area(a);
    for (const Polygon& b : to) {
      exchange += polygon_area(a) * polygon_area(b) *
                  point_kernel(polygon_centroid(a), polygon_normal(a), polygon_centroid(b), polygon_normal(b));
    }
  }
  return exchange / area;
}

// The kernel over a wall and the ceiling, seen from an element on the floor.
void draw_kernel(const std::filesystem::path& folder) {
  Svg svg(640, 400);
  const Polygon extent{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  const Oblique view(-0.45, 0.42, extent, {30, 50}, {470, 330});
  const Vec3d eye(0.75, 0.5, 0), up(0, 0, 1);
  struct Wall {
    Vec3d corner, u, v, normal;
  };
  const std::array<Wall, 2> walls{
      {{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}}}};
  constexpr int n = 24;
  const double largest = 0.75;
  for (const Wall& w : walls) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const auto at = [&](double a, double b) { return w.corner + (a / n) * w.u + (b / n) * w.v; };
        const double k = point_kernel(eye, up, at(i + 0.5, j + 0.5), w.normal);
        const Polygon cell{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
        svg.cell(view(cell), shade(std::round(40 * k / largest) / 40));
      }
    }
  }
  svg.flush_pixels();
  svg.polyline(view(lower_square()), {"#666", 1, "#f4f4f4", 1, ""}, true);
  const Polygon element{{0.70, 0.45, 0}, {0.80, 0.45, 0}, {0.80, 0.55, 0}, {0.70, 0.55, 0}};
  svg.polyline(view(element), {"#a33", 1, "#e15759", 1, ""}, true);
  svg.arrow(view(eye), view(eye + Vec3d(0, 0, 0.3)), {"#a33", 1.6, "", 1, ""});
  svg.text(view(eye + Vec3d(0, 0, 0.3)) + Vec2d(8, 8), "n1", 13);
  svg.arrow(view(eye), view(Vec3d(0, 0.4, 0.45)), {"#222", 1.3, "", 1, ""});
  svg.text(view(Vec3d(0.42, 0.40, 0.23)) + Vec2d(-14, 6), "r", 14, "end");
  svg.text(view(element[0]) + Vec2d(-4, 22), "dA1", 13, "middle");
  for (int k = 0; k < 60; ++k) svg.pixel({560, 300 - 4.0 * k}, {18, 4.2}, shade(k / 59.0));
  svg.flush_pixels();
  for (const double v : {0.0, 0.25, 0.5, 0.75}) svg.text({584, 304 - 240 * v / largest}, fmt::format("{:g}", v), 12);
  svg.text({569, 42}, "dF12 / dA2, 1/m²", 12, "middle");
  svg.text({20, 24}, "The kernel on two walls of a unit cube, seen from an element of its floor", 13);
  svg.write(folder / "point_kernel.svg");
}

}  // namespace

void draw_point(const std::filesystem::path& folder) {
  draw_kernel(folder);
  Svg svg(700, 380);
  Plot plot(svg, {80, 30}, {330, 290}, {1, 32, "squares: distance / side;  n along a side", true, 2, 1},
            {1e-5, 10, "relative error", true, 10, 1});
  std::vector<Vec2d> apart, facing, touching;
  for (int power = 0; power <= 5; ++power) {
    const int n = 1 << power;
    const double exact = polygon_to_polygon(lower_square(), upper_square(n));
    apart.emplace_back(n, std::abs(by_points({lower_square()}, {upper_square(n)}) / exact - 1));
    const double near = polygon_to_polygon(lower_square(), upper_square(1));
    const auto low = subdivided(lower_square(), n);
    facing.emplace_back(n, std::abs(by_points(low, subdivided(upper_square(1), n)) / near - 1));
    const double corner = polygon_to_polygon(lower_square(), standing_square());
    touching.emplace_back(n, std::abs(by_points(low, subdivided(standing_square(), n)) / corner - 1));
    fmt::print("  {:3} apart {:.3e} facing {:.3e} touching {:.3e}\n", n, apart.back().y, facing.back().y,
               touching.back().y);
  }
  plot.curve(touching, hue(3), "touching, n x n parts each");
  plot.curve(facing, hue(0), "facing at 1 side, n x n parts");
  plot.curve(apart, hue(2), "facing, farther and farther");
  plot.slope({4, 3e-3}, -2, 4, 32, "");
  svg.text(plot.place({9, 1.5e-4}), "slope -2", 11, "end", 0, "#666");
  svg.write(folder / "point_convergence.svg");
}

}  // namespace penumbra::figures
