#include "penumbra/radiosity/form_factors/bsp_tree.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <set>

#include "penumbra/radiosity/form_factors/adaptive.h"
#include "scenes.h"
#include "svg.h"

namespace penumbra::figures {
namespace {

// Vertical screens over a plan; a tree of them has vertical planes only.
Polygon screen(const Vec2d& a, const Vec2d& b) { return {{a.x, a.y, 0}, {b.x, b.y, 0}, {b.x, b.y, 1}, {a.x, a.y, 1}}; }

// Eyes that get the fragments in the same order stand in the same cell of the tree.
void draw_cells(const std::filesystem::path& folder) {
  const std::vector<Polygon> screens{screen({0.10, 0.20}, {0.55, 0.15}), screen({0.75, 0.10}, {0.80, 0.55}),
                                     screen({0.30, 0.35}, {0.45, 0.80}), screen({0.10, 0.65}, {0.20, 0.90}),
                                     screen({0.55, 0.85}, {0.90, 0.75}), screen({0.60, 0.45}, {0.95, 0.30})};
  const BspTree tree(mesh_of(screens));
  Svg svg(640, 480);
  const double size = 400;
  const Vec2d corner(30, 45);
  const auto place = [&](double x, double y) { return corner + Vec2d(size * x, size * (1 - y)); };
  constexpr int n = 250;
  std::map<std::vector<double>, std::size_t> cells;
  for (int j = 0; j < n; ++j) {
    std::size_t last = 0;
    int begin = 0;
    const auto fill = [&](int end) {
      const std::string colour = fmt::format("#{:02x}{:02x}{:02x}", 205 + 50 * ((last * 37) % 7) / 7,
                                             205 + 50 * ((last * 53) % 5) / 5, 205 + 50 * ((last * 29) % 11) / 11);
      if (end > begin) {
        svg.pixel(place(static_cast<double>(begin) / n, (j + 1.0) / n), {size * (end - begin) / n, size / n}, colour);
      }
      begin = end;
    };
    for (int i = 0; i < n; ++i) {
      std::vector<double> order;
      tree.front_to_back({(i + 0.5) / n, (j + 0.5) / n, 0.5}, [&](const BspTree::Fragment& f) {
        order.push_back(f.polygon[0].x);
        order.push_back(f.polygon[0].y + 10 * f.polygon[1].x);
      });
      const std::size_t cell = cells.emplace(order, cells.size()).first->second;
      if (cell != last) fill(i);
      last = cell;
    }
    fill(n);
  }
  svg.flush_pixels();
  const Vec3d eye(0.52, 0.52, 0.5);
  int number = 0;
  tree.front_to_back(eye, [&](const BspTree::Fragment& f) {
    Vec2d a(f.polygon[0].x, f.polygon[0].y), b = a;
    for (const Vec3d& v : f.polygon) {
      if (std::hypot(v.x - a.x, v.y - a.y) > std::hypot(b.x - a.x, b.y - a.y)) b = Vec2d(v.x, v.y);
    }
    svg.line(place(a.x, a.y), place(b.x, b.y), {hue(f.patch), 4, "", 1, ""});
    for (const Vec2d& end : {a, b}) svg.circle(place(end.x, end.y), 3, {"#333", 0.8, "#fff", 1, ""});
    const Vec2d side = normalize(Vec2d(b.y - a.y, a.x - b.x));
    svg.text(place((a.x + b.x) / 2, (a.y + b.y) / 2) + 13.0 * Vec2d(side.x, -side.y) + Vec2d(0, 4),
             fmt::format("{}", ++number), 13, "middle");
  });
  svg.circle(place(eye.x, eye.y), 5, {"#222", 1.5, "#fff", 1, ""});
  svg.text(place(eye.x, eye.y) + Vec2d(9, 5), "eye", 12);
  svg.text({20, 24}, "Six screens in plan: the cells of their BSP tree, and the order of the fragments from one eye",
           13);
  svg.text({448, 80}, fmt::format("{} screens", screens.size()), 13);
  svg.text({448, 100}, fmt::format("{} fragments", tree.fragment_count()), 13);
  svg.text({448, 120}, fmt::format("{} cells", cells.size()), 13);
  svg.text({448, 160}, "1 is drawn first:", 12);
  svg.text({448, 178}, "no fragment hides one", 12);
  svg.text({448, 196}, "with a lower number.", 12);
  svg.write(folder / "bsp_tree_cells.svg");
}

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Two squares with a plate just above one of them: tolerance against error, both visibilities.
void compare(const std::filesystem::path& folder) {
  constexpr double truth = 0.1418679263878689;  // independent, semi-analytic
  const PatchMesh plate = mesh_of({lower_square(), upper_square(1)},
                                  {{{0.25, 0.25, 0.01}, {0.75, 0.25, 0.01}, {0.75, 0.75, 0.01}, {0.25, 0.75, 0.01}}});
  Svg svg(720, 380);
  Plot plot(svg, {80, 30}, {330, 290}, {1e-5, 10, "seconds", true, 10, 1}, {1e-12, 0.1, "error of F12", true, 10, 2});
  for (const AdaptiveVisibility visibility : {AdaptiveVisibility::bsp_tree, AdaptiveVisibility::clipping}) {
    const bool bsp = visibility == AdaptiveVisibility::bsp_tree;
    std::vector<Vec2d> points;
    for (int power = 1; power <= (bsp ? 7 : 10); ++power) {
      AdaptiveOptions options;
      options.tolerance = std::pow(10.0, -power);
      options.visibility = visibility;
      double factor = 0, seconds = 1e9;
      for (int repeat = 0; repeat < 3; ++repeat) {
        seconds = std::min(seconds, seconds_of([&] {
                             factor = assemble_factor_matrix(*make_adaptive(plate, options), plate).at(0, 1);
                           }));
      }
      points.emplace_back(seconds, std::max(1e-13, std::abs(factor - truth)));
      fmt::print("  {} {:.0e}: {:.2e} s, error {:.2e}\n", bsp ? "halving, BSP order" : "cut along shadow lines",
                 options.tolerance, seconds, points.back().y);
    }
    plot.curve(points, hue(bsp ? 3 : 0), bsp ? "BSP order, receiver halved" : "clipping along shadow lines");
  }
  svg.write(folder / "bsp_tree_convergence.svg");
}

}  // namespace

void draw_bsp_tree(const std::filesystem::path& folder) {
  draw_cells(folder);
  compare(folder);
}

}  // namespace penumbra::figures
