#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "penumbra/math/rng.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/builtin_parts.h"

// Street canyons: a square grid of flat-roofed buildings of differing heights, as urban-climate models have them. All
// surfaces are cut into squares of one size on one lattice, so that neighbours share their corners.

namespace penumbra {

namespace {

constexpr double cell = 5;              // m, the edge of a facet
constexpr int block_cells = 6;          // pitch of the streets
constexpr int building_cells = 4;       // edge of a building, the rest is street
constexpr int lowest = 2, tallest = 8;  // storeys of one cell

constexpr int expected_facets = block_cells * block_cells + 4 * building_cells * (lowest + tallest) / 2;

using Lattice = std::array<int, 3>;

Vec3d place(const Lattice& at) { return {cell * at[0], cell * at[1], cell * at[2]}; }

/// A rectangle of `across` x `up` squares that starts at `corner`; counter-clockwise seen from the front.
void add_facets(Mesh& mesh, const Lattice& corner, const Lattice& u, int across, const Lattice& v, int up) {
  const auto at = [&](int i, int j) {
    return place({corner[0] + i * u[0] + j * v[0], corner[1] + i * u[1] + j * v[1], corner[2] + i * u[2] + j * v[2]});
  };
  for (int j = 0; j < up; ++j)
    for (int i = 0; i < across; ++i)
      add_face(mesh, std::array<Vec3d, 4>{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
}

int storeys(int x, int z) {
  CounterRng random(hash_key(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(z)));
  return lowest + static_cast<int>(random.next() * (tallest - lowest + 1));
}

Mesh building(int x, int z, std::uint32_t facade, std::uint32_t roof) {
  Mesh mesh;
  mesh.name = "building-" + std::to_string(x) + "-" + std::to_string(z);
  const int n = building_cells, h = storeys(x, z);
  const int x0 = block_cells * x + 1, z0 = block_cells * z + 1, x1 = x0 + n, z1 = z0 + n;
  add_facets(mesh, {x0, 0, z1}, {1, 0, 0}, n, {0, 1, 0}, h);   // towards +z
  add_facets(mesh, {x1, 0, z0}, {-1, 0, 0}, n, {0, 1, 0}, h);  // towards -z
  add_facets(mesh, {x1, 0, z1}, {0, 0, -1}, n, {0, 1, 0}, h);  // towards +x
  add_facets(mesh, {x0, 0, z0}, {0, 0, 1}, n, {0, 1, 0}, h);   // towards -x
  mesh.materials.assign(mesh.triangles.size(), facade);
  add_facets(mesh, {x0, h, z1}, {1, 0, 0}, n, {0, 0, -1}, n);
  mesh.materials.resize(mesh.triangles.size(), roof);
  return mesh;
}

/// The streets between the buildings of a city of `blocks` x `blocks`.
Mesh streets(int blocks, std::uint32_t material) {
  Mesh mesh;
  mesh.name = "streets";
  const int n = block_cells * blocks;
  for (int z = 0; z < n; ++z)
    for (int x = 0; x < n; ++x) {
      const auto in_building = [](int k) { return k % block_cells >= 1 && k % block_cells <= building_cells; };
      if (!in_building(x) || !in_building(z)) add_facets(mesh, {x, 0, z + 1}, {1, 0, 0}, 1, {0, 0, -1}, 1);
    }
  mesh.materials = {material};
  return mesh;
}

}  // namespace

Scene make_city(const BuiltinParameters& parameters) {
  const int blocks = std::max(1, static_cast<int>(std::lround(std::sqrt(parameters["facets"] / expected_facets))));
  Scene scene;
  const std::uint32_t asphalt = add_material(scene, lambertian("asphalt", Rgb(0.1F)));
  const std::uint32_t facade = add_material(scene, lambertian("facade", {0.4F, 0.35F, 0.3F}));
  const std::uint32_t roof = add_material(scene, lambertian("roof", Rgb(0.2F)));
  add_object(scene, streets(blocks, asphalt));
  for (int z = 0; z < blocks; ++z)
    for (int x = 0; x < blocks; ++x) add_object(scene, building(x, z, facade, roof));
  scene.environment = Environment{};
  const double size = cell * block_cells * blocks;
  scene.cameras = {{.name = "camera",
                    .to_world = look_at({0.5 * size, 0.6 * size, 1.6 * size}, {0.5 * size, 0, 0.45 * size}, {0, 1, 0}),
                    .lens = PerspectiveLens{}}};
  return scene;
}

}  // namespace penumbra
