#include "penumbra/radiosity/meshing/sharp_irradiance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "penumbra/radiosity/direct_irradiance.h"
#include "penumbra/radiosity/meshing/adaptive_elements.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/vertex_coloured_scene.h"
#include "radiosity/shadow_floor.h"

namespace penumbra {
namespace {

/// Mean irradiance of each floor element, by 128 points a triangle of its fan.
std::vector<double> element_means(const PatchMesh& floor) {
  std::vector<double> means;
  for (std::size_t e = 0; e < floor.patch_count(); ++e) {
    const auto p = floor.polygon(e);
    double sum = 0, weight = 0;
    constexpr int n = 8;
    for (std::size_t k = 2; k < p.size(); ++k) {
      const Vec3d e1 = p[k - 1] - p[0], e2 = p[k] - p[0];
      const double area = length(cross(e1, e2));
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i + j < n; ++i) {
          for (const double third : {1.0 / 3, 2.0 / 3}) {
            if (third > 0.5 && i + j + 1 == n) continue;
            sum += area * shadow_floor::irradiance(p[0] + ((i + third) / n) * e1 + ((j + third) / n) * e2);
            weight += area;
          }
        }
      }
    }
    means.insert(means.end(), 3, sum / weight);
  }
  return means;
}

double rms(const ShadingMesh& mesh, const std::vector<double>& values) {
  std::vector<double> red;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) red.push_back(values[3 * v]);
  double sum = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const Vec3d p(-1 + 0.02 * (x + 0.37), -1 + 0.02 * (y + 0.61), 0);
      const double error = shadow_floor::interpolate(mesh, red, p) - shadow_floor::irradiance(p);
      sum += error * error;
    }
  }
  return std::sqrt(sum / 10000);
}

TEST(SharpIrradiance, FromElementMeansTheFloorIsFourTimesBetterThanUniformBlended) {
  // What a solver hands over are means of elements. Uniform ones are blended into vertices; those along shadow lines
  // get their direct light at the vertices.
  constexpr std::size_t count = 1600;
  const PatchMesh uniform = shadow_floor::uniform_floor(count);
  const ShadingMesh blended = make_shading_mesh(uniform);
  const double plain = rms(blended, blended.at_vertices(element_means(uniform), 3));

  AdaptiveMeshingOptions options;
  options.element_count = count;
  options.sides = PatchSides::front;
  const AdaptiveMesh made = make_adaptive_elements(shadow_floor::scene(), options);
  const PatchMesh floor = shadow_floor::floor_of(made.elements);
  const Scene scene = shadow_floor::scene();
  const LampIrradiance light(scene, made.patches);
  const SharpIrradiance sharp = sharp_irradiance(light, floor, make_shading_mesh(floor), element_means(floor));
  EXPECT_LT(rms(sharp.mesh, sharp.at_vertices), plain / 8);
  // A penumbra does not jump: no vertex is doubled.
  EXPECT_EQ(sharp.mesh.vertex_count(), make_shading_mesh(floor).vertex_count());
}

TEST(SharpIrradiance, ThePointLightsShadowOfABoxJumps) {
  // A box on the floor, a point light above: vertices on the shadow's outline are doubled, and no triangle has one
  // corner dark and another bright unless it is a small one beside a crossing of lines.
  Scene scene = polygon_scene({floor_rectangle(-3, 3, -3, 3)});
  std::vector<Polygon> box;
  for (const Polygon& p : reversed(room({1, 1, 1}))) box.push_back(moved(p, {-0.5, -0.5, 0}));
  box.erase(box.begin());
  add_polygons(scene, "box", box);
  scene.lights.push_back({"lamp", PointLight{{-1.5, 0.3, 2}, Rgb(1)}});
  AdaptiveMeshingOptions options;
  options.element_count = 1500;
  options.sides = PatchSides::front;
  const AdaptiveMesh made = make_adaptive_elements(scene, options);
  const LampIrradiance light(scene, made.patches);
  const ShadingMesh shading = make_shading_mesh(made.elements);
  const std::vector<double> direct = direct_irradiance(scene, made.elements).irradiance;
  const SharpIrradiance sharp = sharp_irradiance(light, made.elements, shading, direct);
  EXPECT_GT(sharp.mesh.vertex_count(), shading.vertex_count() + 20);
  double smeared = 0;
  for (std::size_t t = 0; t < sharp.mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = sharp.mesh.triangles[t];
    const double low = std::min({sharp.at_vertices[3 * a], sharp.at_vertices[3 * b], sharp.at_vertices[3 * c]});
    const double high = std::max({sharp.at_vertices[3 * a], sharp.at_vertices[3 * b], sharp.at_vertices[3 * c]});
    if (low < 0.2 * high && high > 0.05) {
      smeared += 0.5 * length(cross(sharp.mesh.positions[b] - sharp.mesh.positions[a],
                                    sharp.mesh.positions[c] - sharp.mesh.positions[a]));
    }
  }
  EXPECT_LT(smeared, 0.002 * 36);
}

TEST(SharpIrradiance, KeepsTheLightThatLampsDoNotBring) {
  // Without lamps it is what the shading mesh blends.
  const Scene scene = polygon_scene(room({1, 2, 3}));
  const PatchMesh elements = make_uniform_elements(scene, {.element_size = 0.5, .sides = PatchSides::front}).mesh;
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::front, 8);
  const LampIrradiance light(scene, faces.mesh);
  std::vector<double> irradiance;
  for (const Vec3d& c : elements.centroids) irradiance.insert(irradiance.end(), {c.x, c.y, c.z});
  const ShadingMesh shading = make_shading_mesh(elements);
  const SharpIrradiance sharp = sharp_irradiance(light, elements, shading, irradiance);
  EXPECT_EQ(sharp.at_vertices, shading.at_vertices(irradiance, 3));
}

TEST(VertexColouredScene, LampsGiveBakedColoursCrispShadows) {
  const Scene scene = shadow_floor::scene();
  AdaptiveMeshingOptions meshing;
  meshing.element_count = 3000;
  const PatchMesh elements = make_adaptive_elements(scene, meshing).elements;
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::both, 8);
  const LampIrradiance lamps(scene, faces.mesh);
  const std::vector<double> means = element_means(elements);  // of the floor; the rest is not looked at
  constexpr double reflectance = 0.5;
  const auto rms_of_floor = [&](const LampIrradiance* exact) {
    const Scene coloured = vertex_coloured_scene(elements, means, 1, scene, exact);
    const Mesh& floor = coloured.meshes.at(0);
    double square = 0;
    for (std::size_t v = 0; v < floor.positions.size(); ++v) {
      square += std::pow(floor.colours[v].x - reflectance * shadow_floor::irradiance(floor.positions[v]), 2);
    }
    return std::sqrt(square / static_cast<double>(floor.positions.size()));
  };
  EXPECT_LT(rms_of_floor(&lamps), 0.2 * rms_of_floor(nullptr));
}

TEST(VertexColouredScene, KeepsWhatWasSaidOfObjects) {
  Scene scene = polygon_scene(room({1, 2, 3}));
  scene.instances.push_back({"again", 0, glm::translate(Mat4d(1), Vec3d(5, 0, 0))});
  scene.instances[0].extras = R"({"id":7})";
  scene.meshes[0].extras = R"({"lod":0})";
  scene.extras = R"({"shop":"lamps"})";
  const PatchMesh elements = make_uniform_elements(scene, {.element_size = 1, .sides = PatchSides::front}).mesh;
  const Scene coloured = vertex_coloured_scene(elements, std::vector<double>(3 * elements.patch_count(), 1), 1, scene);
  ASSERT_EQ(coloured.instances.size(), 2U);
  EXPECT_EQ(coloured.instances[0].extras, scene.instances[0].extras);
  EXPECT_EQ(coloured.instances[1].name, "again");
  EXPECT_EQ(coloured.instances[1].extras, "");
  for (const Mesh& mesh : coloured.meshes) EXPECT_EQ(mesh.extras, scene.meshes[0].extras);
  EXPECT_EQ(coloured.extras, scene.extras);
}

TEST(LampIrradiance, KnowsTheConeOfASpot) {
  Scene scene = polygon_scene({floor_rectangle(-2, 2, -2, 2)});
  scene.lights.push_back({"spot", SpotLight{{0, 0, 2}, {0, 0, -1}, Rgb(3), 0.3, 0.6}});
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::front, 8);
  const LampIrradiance light(scene, faces.mesh);
  const auto view = light.view(faces.mesh.polygon(0));
  EXPECT_NEAR(view.at({0, 0, 0}).x, 3.0 / 4, 1e-6);
  EXPECT_EQ(view.at({2 * std::tan(0.61), 0, 0}).x, 0);
}

}  // namespace
}  // namespace penumbra
