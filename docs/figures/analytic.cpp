#include "penumbra/radiosity/form_factors/analytic.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>

#include "penumbra/math/quadrature.h"
#include "penumbra/radiosity/form_factors/edge_pair.h"
#include "scenes.h"
#include "svg.h"

namespace penumbra::figures {
namespace {

using Contributions = std::array<std::array<double, 4>, 4>;

// What each pair of edges adds to A1 F12.
Contributions contributions(const Polygon& a, const Polygon& b) {
  Contributions c{};
  for (std::size_t e = 0; e < 4; ++e) {
    for (std::size_t f = 0; f < 4; ++f) {
      const Edge first(a[e], a[(e + 1) % 4]), second(b[f], b[(f + 1) % 4]);
      c[e][f] = dot(first.direction, second.direction) / (2 * std::numbers::pi) * log_distance_integral(first, second);
    }
  }
  return c;
}

void draw_outline(Svg& svg, const Oblique& view, const Polygon& p, const std::string& colour, const std::string& fill,
                  const char* letter) {
  svg.polyline(view(p), {"", 0, fill, 0.6, ""}, true);
  Vec3d middle(0);
  for (const Vec3d& v : p) middle += v / 4.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3d a = p[k], b = p[(k + 1) % 4], inward = middle - 0.5 * (a + b);
    svg.line(view(a), view(b), {colour, 1.6, "", 1, ""});
    svg.arrow(view(a + 0.42 * (b - a)), view(a + 0.6 * (b - a)), {colour, 1.8, "", 1, ""});
    svg.text(view(0.5 * (a + b) + 0.2 * inward) + Vec2d(0, 4), fmt::format("{}{}", letter, k + 1), 12, "middle");
  }
}

void draw_contours(const std::filesystem::path& folder) {
  Svg svg(700, 390);
  const Polygon a = lower_square(), b = standing_square();
  const Polygon extent{{0, 0, 1}, {0, 1, 1}, {1, 0, 0}, {1, 1, 0}};
  const Oblique view(0.55, 0.5, extent, {30, 50}, {350, 310});
  draw_outline(svg, view, b, "#a33", "#f3c9c9", "f");
  draw_outline(svg, view, a, "#2c5a86", "#c9dcf0", "e");
  const Contributions c = contributions(a, b);
  double largest = 0, sum = 0;
  for (const auto& row : c) {
    for (const double v : row) {
      largest = std::max(largest, std::abs(v));
      sum += v;
    }
  }
  const Vec2d corner(450, 90);
  const double cell = 54;
  for (std::size_t e = 0; e < 4; ++e) {
    svg.text(corner + Vec2d(-10, (static_cast<double>(e) + 0.6) * cell), fmt::format("e{}", e + 1), 13, "end");
    svg.text(corner + Vec2d((static_cast<double>(e) + 0.5) * cell, -10), fmt::format("f{}", e + 1), 13, "middle");
    for (std::size_t f = 0; f < 4; ++f) {
      const double v = c[e][f], t = std::abs(v) / largest;
      const int pale = static_cast<int>(255 - 130 * t);
      const Vec2d at = corner + cell * Vec2d(static_cast<double>(f), static_cast<double>(e));
      const std::array<Vec2d, 4> box{at, at + Vec2d(cell, 0), at + Vec2d(cell, cell), at + Vec2d(0, cell)};
      const std::string fill = v < 0 ? fmt::format("#{0:02x}{0:02x}ff", pale) : fmt::format("#ff{0:02x}{0:02x}", pale);
      svg.polyline(box, {"#999", 0.8, fill, 1, ""}, true);
      svg.text(at + Vec2d(cell / 2, cell / 2 + 4), std::abs(v) < 5e-16 ? "0" : fmt::format("{:.4f}", v), 11, "middle");
    }
  }
  svg.text({20, 24}, "Two squares that share an edge: what each pair of edges adds to A1 F12", 13);
  svg.text(corner + Vec2d(2 * cell, 4 * cell + 28), fmt::format("sum = {:.15f}", sum), 13, "middle");
  svg.text(corner + Vec2d(2 * cell, 4 * cell + 48), fmt::format("closed form = {}", "0.200043776075403"), 13, "middle");
  svg.write(folder / "analytic_contours.svg");
}

// The double contour sum with n Gauss points on every edge of one and n + 1 of the other, so that no two coincide on a
// shared edge.
double by_gauss(const Polygon& a, const Polygon& b, int n) {
  double sum = 0;
  for (std::size_t e = 0; e < 4; ++e) {
    for (std::size_t f = 0; f < 4; ++f) {
      const Vec3d u = a[(e + 1) % 4] - a[e], v = b[(f + 1) % 4] - b[f];
      for (const GaussNode& s : gauss_legendre(n)) {
        for (const GaussNode& t : gauss_legendre(n + 1)) {
          sum += s.weight * t.weight * dot(u, v) * std::log(length(a[e] + s.x * u - b[f] - t.x * v));
        }
      }
    }
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace

void draw_analytic(const std::filesystem::path& folder) {
  draw_contours(folder);
  // Closed forms (Howell's catalogue C-11 and C-14), 16 digits.
  constexpr double facing = 0.1998248956983874, touching = 0.2000437760754030;
  std::vector<Vec2d> apart, near, shared, exact_apart, exact_shared;
  const double near_truth = polygon_to_polygon(lower_square(), upper_square(0.05));
  const auto floor_at = [](double error) { return std::max(error, 1e-16); };
  for (int n = 1; n <= 32; n *= 2) {
    apart.emplace_back(n, floor_at(std::abs(by_gauss(lower_square(), upper_square(1), n) - facing)));
    near.emplace_back(n, floor_at(std::abs(by_gauss(lower_square(), upper_square(0.05), n) - near_truth)));
    shared.emplace_back(n, floor_at(std::abs(by_gauss(lower_square(), standing_square(), n) - touching)));
    exact_apart.emplace_back(n, floor_at(std::abs(polygon_to_polygon(lower_square(), upper_square(1)) - facing)));
    exact_shared.emplace_back(n, floor_at(std::abs(polygon_to_polygon(lower_square(), standing_square()) - touching)));
    fmt::print("  {:3} apart {:.2e} near {:.2e} shared {:.2e}; exact {:.2e} {:.2e}\n", n, apart.back().y, near.back().y,
               shared.back().y, exact_apart.back().y, exact_shared.back().y);
  }
  Svg svg(760, 380);
  Plot plot(svg, {80, 30}, {330, 290}, {1, 32, "Gauss points on each edge", true, 2, 1},
            {1e-17, 1, "error of F12", true, 10, 2});
  plot.curve(shared, hue(3), "plain rule, squares sharing an edge");
  plot.curve(near, hue(1), "plain rule, 0.05 sides apart");
  plot.curve(apart, hue(0), "plain rule, one side apart");
  plot.curve(exact_shared, hue(3), "analytic, sharing an edge", true);
  plot.curve(exact_apart, hue(0), "analytic, one side apart", true);
  svg.write(folder / "analytic_convergence.svg");
}

}  // namespace penumbra::figures
