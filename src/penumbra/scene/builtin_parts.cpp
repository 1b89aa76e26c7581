#include "penumbra/scene/builtin_parts.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "penumbra/math/transform.h"

namespace penumbra {

Material lambertian(std::string name, const Rgb& reflectance, const Rgb& emission) {
  Material material;
  material.name = std::move(name);
  material.base_colour = reflectance;
  material.specular = 0;
  material.emission = emission;
  return material;
}

std::uint32_t add_material(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_object(Scene& scene, Mesh mesh, const Mat4d& to_world) {
  scene.instances.push_back(
      {.name = mesh.name, .mesh = static_cast<std::uint32_t>(scene.meshes.size()), .to_world = to_world});
  scene.meshes.push_back(std::move(mesh));
}

void add_face(Mesh& mesh, std::span<const Vec3d> corners) {
  assert(corners.size() >= 3);
  if (mesh.face_offsets.empty()) mesh.face_offsets.push_back(0);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto face = static_cast<std::uint32_t>(mesh.face_offsets.size() - 1);
  const auto count = static_cast<std::uint32_t>(corners.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    mesh.positions.push_back(corners[i]);
    mesh.face_vertices.push_back(first + i);
  }
  mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.face_vertices.size()));
  for (std::uint32_t i = 2; i < count; ++i) {
    mesh.triangles.push_back({first, first + i - 1, first + i});
    mesh.face_of_triangle.push_back(face);
  }
}

void add_box(Mesh& mesh, const Mat4d& to_world, const Vec3d& half, bool facing_inwards) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3d centre(0), u(0), v(0);
      centre[axis] = side * half[axis];
      u[(axis + 1) % 3] = half[(axis + 1) % 3];
      v[(axis + 2) % 3] = half[(axis + 2) % 3];
      std::array<Vec3d, 4> corners{centre - u - v, centre + u - v, centre + u + v, centre - u + v};
      if ((side < 0) != facing_inwards) std::ranges::reverse(corners);  // u x v points along +axis
      for (Vec3d& corner : corners) corner = transform_point(to_world, corner);
      add_face(mesh, corners);
    }
  }
}

}  // namespace penumbra
