#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"

namespace penumbra::test {

/// A quadrilateral with a chart of its own.
struct Quad {
  std::array<Vec3d, 4> corners;  ///< counter-clockwise seen from the front
  std::uint32_t material = 0;
  int width = 16, height = 16;  ///< texels along the first edge and the second
  std::string name = "quad";
};

/// An atlas laid out by hand, each quadrilateral a mesh, an instance and a chart whose texels divide it evenly.
/// @param scene holds materials and lights.
inline LightmapAtlas quad_atlas(Scene scene, const std::vector<Quad>& quads) {
  constexpr int padding = 4;
  LightmapAtlas atlas;
  int widest = 0, count_across = 1;
  for (const Quad& q : quads) widest = std::max({widest, q.width, q.height});
  while (count_across * count_across < static_cast<int>(quads.size())) ++count_across;
  atlas.width = atlas.height = count_across * (widest + padding);
  atlas.first_triangle = {0};
  for (std::size_t k = 0; k < quads.size(); ++k) {
    const Quad& q = quads[k];
    const auto at = static_cast<int>(k);
    const Chart chart{(at % count_across) * (widest + padding), (at / count_across) * (widest + padding), q.width,
                      q.height, static_cast<std::uint32_t>(k)};
    Mesh mesh;
    mesh.name = q.name;
    mesh.materials = {q.material};
    mesh.positions.assign(q.corners.begin(), q.corners.end());
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.face_offsets = {0, 4};
    mesh.face_vertices = {0, 1, 2, 3};
    mesh.face_of_triangle = {0, 0};
    const auto planar = cross(q.corners[1] - q.corners[0], q.corners[2] - q.corners[0]);
    if (std::abs(dot(normalize(planar), q.corners[3] - q.corners[0])) > 1e-6) {
      mesh.face_offsets = {0, 3, 6};
      mesh.face_vertices = {0, 1, 2, 0, 2, 3};
      mesh.face_of_triangle = {0, 1};
    }
    for (const auto& [right, down] : {std::pair{0, 1}, {1, 1}, {1, 0}, {0, 0}}) {
      mesh.uv[1].emplace_back(static_cast<float>(chart.x + right * q.width) / static_cast<float>(atlas.width),
                              static_cast<float>(chart.y + down * q.height) / static_cast<float>(atlas.height));
    }
    scene.instances.push_back({q.name, static_cast<std::uint32_t>(scene.meshes.size()), Mat4d(1)});
    scene.meshes.push_back(std::move(mesh));
    atlas.charts.push_back(chart);
    atlas.first_triangle.push_back(atlas.first_triangle.back() + 2);
    atlas.chart_of_triangle.insert(atlas.chart_of_triangle.end(), 2, static_cast<std::uint32_t>(k));
  }
  atlas.texels_per_metre = 1;
  atlas.scene = std::move(scene);
  return atlas;
}

/// The faces of a scene of quadrilaterals, `size` texels square each; its meshes and instances are left out.
inline std::vector<Quad> quads_of(const Scene& scene, int size) {
  std::vector<Quad> quads;
  for (const Instance& i : scene.instances) {
    const Mesh& mesh = scene.meshes[i.mesh];
    const auto& p = mesh.positions;
    // A fan of two triangles, of one face or of two.
    quads.push_back({{p[0], p[1], p[2], p.back()}, mesh.materials[0], size, size, i.name});
  }
  return quads;
}

}  // namespace penumbra::test
