#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "penumbra/math/transform.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// Adds a rectangle of two triangles to the mesh, each vertex its own; the front is where a x b points.
inline void add_rectangle(Mesh& mesh, const Vec3d& corner, const Vec3d& a, const Vec3d& b) {
  const auto v = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3d& p : {corner, corner + a, corner + a + b, corner + b}) mesh.positions.push_back(p);
  mesh.triangles.push_back({v, v + 1, v + 2});
  mesh.triangles.push_back({v, v + 2, v + 3});
}

inline Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].name = "grey";
  for (Mesh& mesh : meshes) {
    scene.instances.push_back({.name = mesh.name, .mesh = static_cast<std::uint32_t>(scene.meshes.size())});
    scene.meshes.push_back(std::move(mesh));
  }
  return scene;
}

/// A closed box of six rectangles, seen from inside, vertices doubled at its edges.
inline Mesh inside_of_box(const Vec3d& size) {
  Mesh mesh;
  mesh.name = "box";
  const Vec3d x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  add_rectangle(mesh, Vec3d(0), z, x);
  add_rectangle(mesh, y, x, z);
  add_rectangle(mesh, Vec3d(0), y, z);
  add_rectangle(mesh, x, z, y);
  add_rectangle(mesh, Vec3d(0), x, y);
  add_rectangle(mesh, z, y, x);
  return mesh;
}

inline Vec3d world_corner(const Scene& scene, std::size_t instance, std::size_t triangle, std::size_t k) {
  const Instance& placed = scene.instances[instance];
  const Mesh& mesh = scene.meshes[placed.mesh];
  return transform_point(placed.to_world, mesh.positions[mesh.triangles[triangle][k]]);
}

}  // namespace penumbra
