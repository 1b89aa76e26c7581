#include <array>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <map>
#include <numbers>

#include "penumbra/math/transform.h"
#include "penumbra/scene/builtin_parts.h"

namespace penumbra {

namespace {

using Cell = std::array<int, 3>;

/// A rectangular grid of unit squares: the cell of row i, column j has corners first[k] + i * row + j * column.
struct SquareGrid {
  std::array<Cell, 4> first;
  Cell row;
  Cell column;
  int rows = 1;
  int columns = 1;
};

// The 3 x 4 x 5 box that View3D ships as an example: file order of the surfaces and of their corners, z up.
constexpr std::array<SquareGrid, 6> box_walls{{
    {{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, {0, 1, 0}, {1, 0, 0}, 4, 5},
    {{{{0, 1, 3}, {1, 1, 3}, {1, 0, 3}, {0, 0, 3}}}, {0, 1, 0}, {1, 0, 0}, 4, 5},
    {{{{0, 4, 0}, {1, 4, 0}, {1, 4, 1}, {0, 4, 1}}}, {0, 0, 1}, {1, 0, 0}, 3, 5},
    {{{{0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0}}}, {0, 0, 1}, {1, 0, 0}, 3, 5},
    {{{{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}}}, {0, 0, 1}, {0, 1, 0}, 3, 4},
    {{{{5, 0, 0}, {5, 0, 1}, {5, 1, 1}, {5, 1, 0}}}, {0, 0, 1}, {0, 1, 0}, 3, 4},
}};
constexpr std::array<std::array<Cell, 4>, 6> cube_faces{{
    {{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}},
    {{{0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0}}},
    {{{0, 1, 0}, {0, 0, 0}, {0, 0, 1}, {0, 1, 1}}},
    {{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}},
    {{{1, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}},
    {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}},
}};

Cell moved(const Cell& cell, const Cell& by, int times = 1) {
  return {cell[0] + times * by[0], cell[1] + times * by[1], cell[2] + times * by[2]};
}

/// Quads between points of the integer grid, with vertices shared.
class GridMesh {
 public:
  explicit GridMesh(std::string name) {
    mesh_.name = std::move(name);
    mesh_.materials.clear();
    mesh_.face_offsets.push_back(0);
  }

  void add_quad(const std::array<Cell, 4>& corners, const Cell& at, std::uint32_t material) {
    std::array<std::uint32_t, 4> v{};
    for (std::size_t k = 0; k < 4; ++k) v[k] = vertex(moved(corners[k], at));
    const auto face = static_cast<std::uint32_t>(mesh_.face_offsets.size() - 1);
    mesh_.face_vertices.insert(mesh_.face_vertices.end(), v.begin(), v.end());
    mesh_.face_offsets.push_back(static_cast<std::uint32_t>(mesh_.face_vertices.size()));
    mesh_.triangles.push_back({v[0], v[1], v[2]});
    mesh_.triangles.push_back({v[0], v[2], v[3]});
    mesh_.face_of_triangle.insert(mesh_.face_of_triangle.end(), {face, face});
    mesh_.materials.insert(mesh_.materials.end(), {material, material});
  }

  [[nodiscard]] Mesh take() { return std::move(mesh_); }

 private:
  std::uint32_t vertex(const Cell& at) {
    const auto [entry, added] = vertices_.try_emplace(at, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (added) mesh_.positions.emplace_back(at[0], at[1], at[2]);
    return entry->second;
  }

  Mesh mesh_;
  std::map<Cell, std::uint32_t> vertices_;
};

Mesh cube(std::string name, const Cell& at, std::uint32_t material) {
  GridMesh mesh(std::move(name));
  for (const std::array<Cell, 4>& face : cube_faces) mesh.add_quad(face, at, material);
  return mesh.take();
}

}  // namespace

Scene make_furnace(const BuiltinParameters& parameters) {
  const auto rho = static_cast<float>(parameters["rho"]);
  const auto emission = static_cast<float>(parameters["emission"]);
  Scene scene;
  scene.materials = {lambertian("furnace", Rgb(rho), Rgb(emission))};
  Mesh room;
  room.name = "room";
  add_box(room, Mat4d(1.0), Vec3d(1), true);
  add_object(scene, std::move(room));
  Mesh box;  // so that the cavity is not convex: some of it hides behind
  box.name = "box";
  const Mat4d tilted = glm::rotate(glm::translate(Mat4d(1.0), Vec3d(0.2, -0.3, -0.25)), 0.6, normalize(Vec3d(1, 2, 3)));
  add_box(box, tilted, Vec3d(0.35, 0.3, 0.25), false);
  add_object(scene, std::move(box));
  scene.cameras = {{.name = "camera",
                    .to_world = look_at({-0.7, 0.3, 0.8}, {0.2, -0.2, -0.3}, {0, 1, 0}),
                    .lens = PerspectiveLens{1.2}}};
  return scene;
}

Scene make_box345(const BuiltinParameters& parameters) {
  const auto cubes = static_cast<int>(parameters["cubes"]);
  Scene scene;
  const std::uint32_t wall = add_material(scene, lambertian("wall", {0.7F, 0.68F, 0.64F}));
  const std::uint32_t lamp = add_material(scene, lambertian("lamp", {0.7F, 0.68F, 0.64F}, Rgb(4.0F)));
  const std::uint32_t first_cube = add_material(scene, lambertian("cube A", {0.65F, 0.3F, 0.12F}));
  const std::uint32_t second_cube = add_material(scene, lambertian("cube B", {0.15F, 0.38F, 0.6F}));

  // Numbers as in the file, z up; the instances turn it to +Y up.
  constexpr Mat4d upright(Vec4d(1, 0, 0, 0), Vec4d(0, 0, -1, 0), Vec4d(0, 1, 0, 0), Vec4d(0, 0, 0, 1));
  GridMesh room("room");
  for (const SquareGrid& grid : box_walls) {
    const bool ceiling = grid.first[0][2] == 3;
    for (int i = 0; i < grid.rows; ++i) {
      for (int j = 0; j < grid.columns; ++j) {
        const bool shines = ceiling && (i == 1 || i == 2) && j >= 1 && j <= 3;
        room.add_quad(grid.first, moved(moved({0, 0, 0}, grid.row, i), grid.column, j), shines ? lamp : wall);
      }
    }
  }
  add_object(scene, room.take(), upright);
  if (cubes >= 1) add_object(scene, cube("cube A", {1, 1, 1}, first_cube), upright);
  if (cubes >= 2) add_object(scene, cube("cube B", {3, 2, 1}, second_cube), upright);

  const Vec3d eye = transform_point(upright, {0.15, 3.85, 2.0});
  scene.cameras = {{.name = "camera",
                    .to_world = look_at(eye, transform_point(upright, {2.5, 2.0, 1.35}), {0, 1, 0}),
                    .lens = PerspectiveLens{75 * std::numbers::pi / 180}}};
  return scene;
}

}  // namespace penumbra
