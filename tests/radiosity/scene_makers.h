#pragma once

#include <string>
#include <vector>

#include "penumbra/scene/scene.h"
#include "radiosity/polygon_makers.h"

namespace penumbra {

/// Adds a mesh of polygons and an instance of it. Each face is fanned into triangles, as a reader would.
inline Mesh& add_polygons(Scene& scene, const std::string& name, const std::vector<Polygon>& faces,
                          std::uint32_t material = 0, const Mat4d& to_world = Mat4d(1)) {
  Mesh mesh;
  mesh.name = name;
  mesh.materials = {material};
  mesh.face_offsets = {0};
  for (const Polygon& face : faces) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t k = 0; k < face.size(); ++k) {
      mesh.positions.push_back(face[k]);
      mesh.face_vertices.push_back(first + k);
      if (k < 2) continue;
      mesh.triangles.push_back({first, first + k - 1, first + k});
      mesh.face_of_triangle.push_back(static_cast<std::uint32_t>(mesh.face_offsets.size() - 1));
    }
    mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.face_vertices.size()));
  }
  scene.instances.push_back({name, static_cast<std::uint32_t>(scene.meshes.size()), to_world});
  return scene.meshes.emplace_back(std::move(mesh));
}

inline Scene polygon_scene(const std::vector<Polygon>& faces) {
  Scene scene;
  scene.materials.emplace_back();
  add_polygons(scene, "thing", faces);
  return scene;
}

/// A scene's material without specular layer.
inline Material matt(double reflectance, double emitted_radiance = 0) {
  Material material;
  material.base_colour = Rgb(static_cast<float>(reflectance));
  material.emission = Rgb(static_cast<float>(emitted_radiance));
  material.specular = 0;
  return material;
}

}  // namespace penumbra
