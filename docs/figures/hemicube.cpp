#include "penumbra/radiosity/form_factors/hemicube.h"

#include <fmt/core.h>

#include <cmath>
#include <memory>

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "scenes.h"
#include "svg.h"

namespace penumbra::figures {
namespace {

// The five faces laid flat: where the point (u along the rows, v up) of a face lies, the top being [-1, 1] x [-1, 1].
Vec2d laid_flat(std::size_t face, double u, double v) {
  switch (face) {
    case 0:
      return {u, v};
    case 1:
      return {2 - v, u};
    case 2:
      return {-u, 2 - v};
    case 3:
      return {v - 2, -u};
    default:
      return {u, v - 2};
  }
}

void draw_pixels(const std::filesystem::path& folder) {
  const PatchMesh mesh = model_mesh("box345_AB1.0.vs3");
  constexpr int n = 48;
  const auto deltas = std::make_shared<const HemicubeDeltas>(n);
  Hemicube hemicube(deltas);
  const std::uint32_t from = 5;
  hemicube.place(mesh.centroids[from], Frame(mesh.normals[from]));
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    if (p != from) hemicube.draw(mesh.polygon(p), p);
  }
  Svg svg(640, 600);
  const double unit = 140;
  const Vec2d centre(310, 320);
  for (std::size_t face = 0; face < 5; ++face) {
    const int rows = face == 0 ? n : n / 2;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0, next = 0; column < n; column = next) {
        const std::uint32_t item = hemicube.items(face)[static_cast<std::size_t>(row * n + column)];
        while (next < n && hemicube.items(face)[static_cast<std::size_t>(row * n + next)] == item) ++next;
        const auto at = [&](double c, double r) {
          const Vec2d p = laid_flat(face, 2 * c / n - 1, face == 0 ? 2 * r / n - 1 : 2 * r / n);
          return Vec2d(centre.x + unit * p.x, centre.y - unit * p.y);
        };
        const Vec2d a = at(column, row), b = at(next, row + 1);
        const std::string colour = item == Hemicube::nothing ? "#222222" : hue(item * 7 + item / 10);
        svg.pixel({std::min(a.x, b.x), std::min(a.y, b.y)}, {std::abs(b.x - a.x), std::abs(b.y - a.y)}, colour);
      }
    }
  }
  svg.flush_pixels();
  for (std::size_t face = 0; face < 5; ++face) {
    std::vector<Vec2d> rim;
    for (const Vec2d& q : {Vec2d(-1, face == 0 ? -1 : 0), Vec2d(1, face == 0 ? -1 : 0), Vec2d(1, 1), Vec2d(-1, 1)}) {
      const Vec2d p = laid_flat(face, q.x, q.y);
      rim.emplace_back(centre.x + unit * p.x, centre.y - unit * p.y);
    }
    svg.polyline(rim, {"#000", 1.5, "", 1, ""}, true);
  }
  svg.text({20, 24}, "What the pixels of a hemicube see (48 x 48 on top), laid flat; a colour is a patch", 13);
  svg.text({20, 500}, "the 3 x 4 x 5 box", 12);
  svg.text({20, 518}, "with two cubes,", 12);
  svg.text({20, 536}, "from a patch of a wall", 12);
  svg.text({470, 500}, "middle: the top", 12);
  svg.text({470, 518}, "around it: the sides", 12);
  svg.write(folder / "hemicube_pixels.svg");
}

// One element of a closed room: the sum over the walls of |hemicube - Lambert|.
double aliasing(const std::vector<Polygon>& walls, const PatchMesh& mesh, const Vec3d& eye, int n) {
  const auto f = hemicube_factors(mesh, eye, Frame(Vec3d(0, 0, 1)), n);
  double error = 0;
  for (std::size_t p = 0; p < walls.size(); ++p)
    error += std::abs(f[p] - point_to_polygon(eye, Vec3d(0, 0, 1), walls[p]));
  return error;
}

}  // namespace

void draw_hemicube(const std::filesystem::path& folder) {
  draw_pixels(folder);
  // A wall and the ceiling of a unit cube, in 64 parts each, from an element of the floor.
  std::vector<Polygon> walls = subdivided(upper_square(1), 8);
  for (const Polygon& p : subdivided(standing_square(), 8)) walls.push_back(p);
  const PatchMesh empty = mesh_of(walls);
  const ReferenceBox box = reference_box();
  std::vector<Vec2d> element, plain, near;
  for (int n = 16; n <= 512; n *= 2) {
    double sum = 0;
    for (int k = 0; k < 16; ++k) sum += aliasing(walls, empty, {0.31 + 0.023 * k, 0.43 + 0.011 * k, 0}, n) / 16;
    element.emplace_back(n, sum);
    const auto mean_error = [&](double within) {
      HemicubeOptions options;
      options.resolution = n;
      options.exact_within = within;
      return row_errors(assemble_factor_matrix(*make_hemicube(box.mesh, options), box.mesh), box.factors).mean;
    };
    plain.emplace_back(n, mean_error(0));
    near.emplace_back(n, mean_error(5));
    fmt::print("  {:4} element {:.3e} plain {:.3e} near {:.3e}\n", n, element.back().y, plain.back().y, near.back().y);
  }
  Svg svg(740, 380);
  Plot plot(svg, {80, 30}, {330, 290}, {16, 512, "N: pixels along the top", true, 2, 1},
            {1e-3, 1, "sum over a row of |error|, mean", true, 10, 1});
  plot.curve(plain, hue(3), "box with two cubes: plain");
  plot.curve(near, hue(1), "the same, near pairs exact");
  plot.curve(element, hue(0), "one element, empty room: pixels alone");
  plot.slope({16, 0.4}, -1, 16, 512, "");
  svg.text(plot.place({64, 0.13}), "slope -1", 11, "start", 0, "#666");
  svg.write(folder / "hemicube_convergence.svg");
}

}  // namespace penumbra::figures
