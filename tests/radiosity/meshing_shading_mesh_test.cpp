#include "penumbra/radiosity/meshing/shading_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/polygon_division.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

PatchMesh elements_of(const std::vector<Polygon>& faces, double size, PatchSides sides = PatchSides::front) {
  return make_uniform_elements(polygon_scene(faces), {.element_size = size, .sides = sides}).mesh;
}

/// Elements as they are given, each a face of its own.
PatchMesh elements_as(const std::vector<Polygon>& faces) { return elements_of(faces, 0); }

/// A floor of squares, some of them quartered again and again: as many T-vertices as can be.
std::vector<Polygon> quadtree_floor() {
  std::vector<Polygon> cells;
  const std::function<void(double, double, double, int)> split = [&](double x, double y, double size, int depth) {
    const bool inside = std::hypot(x + size / 2 - 0.3, y + size / 2 - 0.4) < 0.25 + size;
    if (depth == 5 || (depth > 0 && !inside)) {
      cells.push_back(floor_rectangle(x, x + size, y, y + size));
      return;
    }
    for (int k = 0; k < 4; ++k) split(x + (k % 2) * size / 2, y + (k / 2) * size / 2, size / 2, depth + 1);
  };
  split(0, 0, 1, 0);
  return cells;
}

double triangle_area(const ShadingMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return 0.5 * length(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
}

using PositionEdge = std::pair<std::array<double, 3>, std::array<double, 3>>;

/// How many triangles run along each directed edge, by the positions of its ends.
std::map<PositionEdge, int> directed_edges(const ShadingMesh& mesh) {
  std::map<PositionEdge, int> count;
  const auto key = [&](std::uint32_t v) {
    return std::array{mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z};
  };
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++count[{key(t[k]), key(t[(k + 1) % 3])}];
  }
  return count;
}

std::vector<double> centroid_values(const PatchMesh& mesh, const std::function<double(const Vec3d&)>& f) {
  std::vector<double> values;
  for (const Vec3d& c : mesh.centroids) values.push_back(f(c));
  return values;
}

TEST(ShadingMesh, TrianglesCoverTheElementsAndPointToTheirSide) {
  for (const PatchMesh& mesh :
       {elements_as(quadtree_floor()), elements_of(room({1, 2, 3}), 0.3),
        elements_of({floor_disk(1, 0, 9), floor_rectangle(3, 4, 0, 1)}, 0.2, PatchSides::both)}) {
    const ShadingMesh shading = make_shading_mesh(mesh);
    std::vector<double> area(mesh.patch_count(), 0);
    for (std::size_t t = 0; t < shading.triangles.size(); ++t) {
      const std::uint32_t e = shading.element_of_triangle[t];
      EXPECT_GT(triangle_area(shading, t), 1e-6 * mesh.areas[e]);
      const auto& [a, b, c] = shading.triangles[t];
      const Vec3d n = cross(shading.positions[b] - shading.positions[a], shading.positions[c] - shading.positions[a]);
      EXPECT_GT(dot(n, mesh.normals[e]), 0);
      area[e] += triangle_area(shading, t);
    }
    for (std::size_t e = 0; e < mesh.patch_count(); ++e) EXPECT_NEAR(area[e], mesh.areas[e], 1e-12);
  }
}

TEST(ShadingMesh, EveryInnerEdgeIsSharedByTwoTriangles) {
  // Of a closed room cut unevenly, one wall a quadtree: every edge runs once each way.
  PatchMesh coarse = make_element_faces(polygon_scene(room({1, 1, 1})), PatchSides::front, 8).mesh;
  ElementBuilder builder(coarse);
  for (const Polygon& cell : quadtree_floor()) builder.add(0, cell);
  for (std::uint32_t wall = 1; wall < 6; ++wall) {
    divide_polygon(coarse.polygon(wall), 1 / (wall + 0.5),
                   [&](std::span<const Vec3d> cell) { builder.add(wall, cell); });
  }
  const PatchMesh mesh = std::move(builder).finish();
  const ShadingMesh shading = make_shading_mesh(mesh);
  const auto edges = directed_edges(shading);
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  // The mesh needed mending: by elements alone it would not close.
  EXPECT_GT(shading.triangles.size(), 2 * mesh.patch_count());
}

TEST(ShadingMesh, LinearFunctionsAreReproducedInside) {
  const auto linear = [](const Vec3d& p) { return 3 + 2 * p.x - 0.7 * p.y; };
  const auto inside = [](const Vec3d& p) { return p.x > 1e-9 && p.x < 1 - 1e-9 && p.y > 1e-9 && p.y < 1 - 1e-9; };
  for (const PatchMesh& mesh : {elements_of({floor_rectangle(0, 1, 0, 1)}, 0.1), elements_as(quadtree_floor())}) {
    const ShadingMesh shading = make_shading_mesh(mesh);
    const std::vector<double> values = shading.at_vertices(centroid_values(mesh, linear), 1);
    int checked = 0;
    for (std::size_t v = 0; v < shading.vertex_count(); ++v) {
      if (!inside(shading.positions[v])) continue;
      ++checked;
      EXPECT_NEAR(values[v], linear(shading.positions[v]), 1e-9);
    }
    EXPECT_GT(checked, 50);
  }
}

TEST(ShadingMesh, WeightsAreAMean) {
  const ShadingMesh shading = make_shading_mesh(elements_as(quadtree_floor()));
  for (std::size_t v = 0; v < shading.vertex_count(); ++v) {
    double sum = 0;
    for (std::uint32_t k = shading.offsets[v]; k < shading.offsets[v + 1]; ++k) {
      EXPECT_GT(shading.weights[k], 0);
      sum += shading.weights[k];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

TEST(ShadingMesh, NothingIsBlendedOverACubesEdge) {
  const PatchMesh mesh = elements_of(reversed(room({1, 1, 1})), 0.25);
  const ShadingMesh shading = make_shading_mesh(mesh);
  std::vector<double> face_number;
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) face_number.push_back(mesh.surfaces[e].face);
  const std::vector<double> values = shading.at_vertices(face_number, 1);
  for (std::size_t t = 0; t < shading.triangles.size(); ++t) {
    for (const std::uint32_t v : shading.triangles[t]) {
      EXPECT_NEAR(values[v], face_number[shading.element_of_triangle[t]], 1e-12);
    }
  }
  EXPECT_EQ(shading.vertex_count(), 6U * 25U);
}

TEST(ShadingMesh, ABallIsSmoothAllOver) {
  Scene scene;
  scene.materials.emplace_back();
  scene.shapes = {{"ball", Sphere{{0, 0, 0}, 1}, 0}};
  const PatchMesh mesh = make_uniform_elements(scene, {.sides = PatchSides::front}).mesh;
  const ShadingMesh shading = make_shading_mesh(mesh);
  // Poles and 15 rings of 32.
  EXPECT_EQ(shading.vertex_count(), 2U + 15U * 32U);
  for (std::size_t v = 0; v < shading.vertex_count(); ++v) {
    EXPECT_GT(dot(shading.normals[v], shading.positions[v]), 0.999);
  }
}

TEST(ShadingMesh, AWallOnTheFloorPartsItsLight) {
  // Two halves of a floor, and a wall upon the line between them.
  const std::vector<Polygon> with_wall{
      floor_rectangle(0, 1, 0, 1), floor_rectangle(1, 2, 0, 1), {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}}};
  const std::vector<Polygon> without(with_wall.begin(), with_wall.begin() + 2);
  for (const bool wall : {true, false}) {
    const PatchMesh mesh = elements_of(wall ? with_wall : without, 0.5, PatchSides::both);
    const ShadingMesh shading = make_shading_mesh(mesh);
    const auto half = centroid_values(mesh, [](const Vec3d& p) { return p.x > 1 ? 1.0 : 0.0; });
    const std::vector<double> values = shading.at_vertices(half, 1);
    int blended = 0;
    for (std::size_t v = 0; v < shading.vertex_count(); ++v) {
      if (shading.positions[v].z == 0 && shading.positions[v].x == 1 && values[v] > 0.1 && values[v] < 0.9) ++blended;
    }
    EXPECT_EQ(blended, wall ? 0 : 6);  // three vertices on the line, above and below
  }
}

TEST(ShadingMesh, FrontAndBackNeverMix) {
  const PatchMesh mesh = elements_of({floor_rectangle(0, 1, 0, 1), floor_disk(0.4, 2, 7)}, 0.2, PatchSides::both);
  const ShadingMesh shading = make_shading_mesh(mesh);
  std::vector<double> back;
  for (const PatchSurface& s : mesh.surfaces) back.push_back(s.back ? 1 : 0);
  const std::vector<double> values = shading.at_vertices(back, 1);
  for (std::size_t t = 0; t < shading.triangles.size(); ++t) {
    for (const std::uint32_t v : shading.triangles[t])
      EXPECT_NEAR(values[v], back[shading.element_of_triangle[t]], 1e-12);
  }
}

TEST(ShadingMesh, BlendedVerticesApproachTheFunctionAtSecondOrder) {
  // The error inside falls by four when elements are halved.
  const auto smooth = [](const Vec3d& p) { return std::sin(3 * p.x) * std::cos(2 * p.y); };
  double error[2] = {0, 0};
  for (int level = 0; level < 2; ++level) {
    const double size = level == 0 ? 0.1 : 0.05;
    const PatchMesh mesh = elements_of({floor_rectangle(0, 1, 0, 1)}, size);
    const ShadingMesh shading = make_shading_mesh(mesh);
    const auto values = shading.at_vertices(centroid_values(mesh, smooth), 1);
    for (std::size_t v = 0; v < shading.vertex_count(); ++v) {
      const Vec3d p = shading.positions[v];
      if (std::min({p.x, p.y, 1 - p.x, 1 - p.y}) > 1e-6) {
        error[level] = std::max(error[level], std::abs(values[v] - smooth(p)));
      }
    }
  }
  EXPECT_LT(error[1], 0.3 * error[0]);
  EXPECT_GT(error[0], 0);
}

}  // namespace
}  // namespace penumbra
