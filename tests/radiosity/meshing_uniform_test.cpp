#include "penumbra/radiosity/meshing/uniform.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/meshing/face_table.h"
#include "penumbra/radiosity/meshing/polygon_division.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

PatchMesh elements_of(const Scene& scene, double size, PatchSides sides = PatchSides::front) {
  return make_uniform_elements(scene, {.element_size = size, .sides = sides}).mesh;
}

double total_area(const PatchMesh& mesh) {
  double sum = 0;
  for (const double area : mesh.areas) sum += area;
  return sum;
}

double longest_edge(std::span<const Vec3d> p) {
  double longest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) longest = std::max(longest, length(p[(i + 1) % p.size()] - p[i]));
  return longest;
}

/// Diameter squared over area: 2 for a square, 2.3 for an equilateral triangle.
double slenderness(std::span<const Vec3d> p) {
  double widest = 0;
  for (const Vec3d& a : p) {
    for (const Vec3d& b : p) widest = std::max(widest, length_squared(b - a));
  }
  return widest / polygon_area(p);
}

/// How many elements a point of their plane lies in; points are random, so lines between elements are never met.
int elements_around(const PatchMesh& mesh, const Vec3d& p) {
  int count = 0;
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) count += convex_contains(mesh.polygon(e), p) ? 1 : 0;
  return count;
}

TEST(UniformElements, ARectangleBecomesAGridOfCeilEdgeOverSize) {
  const PatchMesh mesh = elements_of(polygon_scene({floor_rectangle(0, 3, 0, 2)}), 0.7);
  EXPECT_EQ(mesh.patch_count(), 5U * 3U);
  for (const double area : mesh.areas) EXPECT_NEAR(area, 6.0 / 15, 1e-12);
  EXPECT_EQ(mesh.vertices.size(), 6U * 4U);
  // A size that divides the edge up to rounding makes no part more.
  EXPECT_EQ(elements_of(polygon_scene({floor_rectangle(0, 0.3, 0, 0.3)}), 0.1).patch_count(), 9U);
}

TEST(UniformElements, ATriangleBecomesSimilarTriangles) {
  const Polygon triangle{{0, 0, 0}, {3, 0, 1}, {1, 2, 0}};
  const PatchMesh mesh = elements_of(polygon_scene({triangle}), 1);
  const auto n = static_cast<std::size_t>(std::ceil(longest_edge(triangle)));
  ASSERT_EQ(mesh.patch_count(), n * n);
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    EXPECT_NEAR(mesh.areas[e], polygon_area(triangle) / double(n * n), 1e-12);
    EXPECT_NEAR(longest_edge(mesh.polygon(e)), longest_edge(triangle) / double(n), 1e-12);
    EXPECT_GT(dot(mesh.normals[e], polygon_normal(triangle)), 1 - 1e-12);
  }
  EXPECT_EQ(mesh.vertices.size(), (n + 1) * (n + 2) / 2);
}

TEST(UniformElements, WithoutALimitEachPolygonIsOneElement) {
  const PatchMesh mesh = elements_of(polygon_scene(room({3, 4, 5})), 0);
  ASSERT_EQ(mesh.patch_count(), 6U);
  for (std::uint32_t e = 0; e < 6; ++e) EXPECT_EQ(mesh.surfaces[e].face, e);
}

TEST(UniformElements, AnyConvexPolygonIsCoveredOnceByPiecesOfGoodShape) {
  Dice dice(5);
  for (int round = 0; round < 40; ++round) {
    const Polygon polygon = dice.convex_polygon();
    const double size = dice.between(0.05, 0.4);
    const PatchMesh mesh = elements_of(polygon_scene({polygon}), size);
    EXPECT_NEAR(total_area(mesh), polygon_area(polygon), 1e-12);
    EXPECT_EQ(mesh.patch_count(), count_cells(polygon, size));
    for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
      EXPECT_LE(longest_edge(mesh.polygon(e)), size * (1 + 1e-9));
      EXPECT_TRUE(is_convex(mesh.polygon(e)));
      EXPECT_LE(planarity_error(mesh.polygon(e)), 1e-12);
    }
    for (int k = 0; k < 20; ++k) {
      // A random mixture of the corners.
      Vec3d p(0);
      double weight = 0;
      for (const Vec3d& corner : polygon) {
        const double w = dice.between(0, 1);
        p += w * corner;
        weight += w;
      }
      EXPECT_EQ(elements_around(mesh, p / weight), 1);
    }
  }
}

TEST(UniformElements, RoundAndThinFacesKeepGoodAspect) {
  for (const Polygon& polygon :
       {floor_disk(1, 0, 32), Polygon{{0, 0, 0}, {4, 0, 0}, {4, 0.1, 0}}, floor_disk(1, 0, 7)}) {
    const PatchMesh mesh = elements_of(polygon_scene({polygon}), 0.1);
    double sum = 0;
    for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
      sum += slenderness(mesh.polygon(e));
      // The tip of a needle stays one.
      EXPECT_LT(slenderness(mesh.polygon(e)), polygon.size() == 3 ? 100 : 12) << polygon.size();
    }
    EXPECT_LT(sum / double(mesh.patch_count()), 5) << polygon.size();
    // The size is used, not undercut by far.
    EXPECT_GT(total_area(mesh) / double(mesh.patch_count()), 0.1 * 0.1 / 6);
  }
}

TEST(UniformElements, ConcaveFacesKeepTheirFaceNumber) {
  const Polygon el{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  const PatchMesh mesh = elements_of(polygon_scene({el, floor_rectangle(5, 6, 0, 1)}), 0.25);
  double area[2] = {0, 0};
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) area[mesh.surfaces[e].face] += mesh.areas[e];
  EXPECT_NEAR(area[0], 3, 1e-12);
  EXPECT_NEAR(area[1], 1, 1e-12);
}

TEST(UniformElements, BothSidesAreCoincidentPairs) {
  const PatchMesh mesh =
      elements_of(polygon_scene({floor_disk(1, 0, 7), {{3, 0, 0}, {5, 0, 1}, {4, 2, 0}}, floor_rectangle(6, 7, 0, 3)}),
                  0.3, PatchSides::both);
  std::map<std::multiset<std::uint32_t>, std::vector<std::size_t>> with_corners;
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    with_corners[{mesh.patch_corners(e).begin(), mesh.patch_corners(e).end()}].push_back(e);
  }
  EXPECT_EQ(with_corners.size() * 2, mesh.patch_count());
  for (const auto& [corners, pair] : with_corners) {
    ASSERT_EQ(pair.size(), 2U);
    EXPECT_NE(mesh.surfaces[pair[0]].back, mesh.surfaces[pair[1]].back);
    EXPECT_EQ(mesh.surfaces[pair[0]].face, mesh.surfaces[pair[1]].face);
    EXPECT_LT(dot(mesh.normals[pair[0]], mesh.normals[pair[1]]), -1 + 1e-9);
  }
}

TEST(UniformElements, NeighbouringRectanglesShareTheirCorners) {
  // A room of odd measures: its six walls' grids meet in the same vertices, bit by bit.
  const PatchMesh mesh = elements_of(polygon_scene(room({1.1, 1.7, 2.3})), 0.3);
  const std::size_t nx = 4, ny = 6, nz = 8;
  EXPECT_EQ(mesh.patch_count(), 2 * (nx * ny + ny * nz + nz * nx));
  EXPECT_EQ(mesh.vertices.size(), (nx + 1) * (ny + 1) * (nz + 1) - (nx - 1) * (ny - 1) * (nz - 1));
}

TEST(UniformElements, ACountIsMetWithinAFewPercent) {
  const Scene scene = polygon_scene(room({3, 4, 2.5}));
  for (const std::size_t count : {200U, 3000U, 20000U}) {
    for (const PatchSides sides : {PatchSides::front, PatchSides::both}) {
      const auto made = make_uniform_elements(scene, {.element_count = count, .sides = sides});
      EXPECT_NEAR(double(made.mesh.surface_count()), double(count), 0.1 * double(count));
    }
  }
  // Fewer than there are polygons: each stays whole.
  EXPECT_EQ(make_uniform_elements(scene, {.element_count = 2, .sides = PatchSides::front}).mesh.surface_count(), 6U);
}

TEST(UniformElements, InstancesAndMirrorsKeepTheirFront) {
  Scene scene;
  scene.materials.emplace_back();
  add_polygons(scene, "a", {floor_rectangle(0, 1, 0, 1)});
  Mat4d mirror(1);
  mirror[0][0] = -2;
  mirror[3] = Vec4d(-1, 0, 3, 1);
  scene.instances.push_back({"b", 0, mirror});
  const PatchMesh mesh = elements_of(scene, 0.5);
  ASSERT_EQ(mesh.patch_count(), 4U + 8U);
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    EXPECT_NEAR(mesh.normals[e].z, 1, 1e-12);
    EXPECT_EQ(mesh.surfaces[e].object, e < 4 ? 0U : 1U);
    EXPECT_EQ(mesh.surfaces[e].name, e < 4 ? "a" : "b");
    EXPECT_EQ(mesh.centroids[e].z, e < 4 ? 0.0 : 3.0);
  }
}

TEST(UniformElements, RoundShapesApproachTheirArea) {
  Scene scene;
  scene.materials.emplace_back();
  scene.shapes = {{"ball", Sphere{{0, 1, 0}, 1}, 0}, {"plate", Disk{{3, 0, 0}, {0, 1, 0}, 1}, 0}};
  const auto made = make_uniform_elements(scene, {.element_size = 0.2, .sides = PatchSides::front});
  double area[2] = {0, 0};
  for (std::size_t e = 0; e < made.mesh.patch_count(); ++e) {
    area[made.mesh.surfaces[e].object] += made.mesh.areas[e];
    EXPECT_LE(longest_edge(made.mesh.polygon(e)), 0.2 * (1 + 1e-9));
  }
  EXPECT_NEAR(area[0], 4 * std::numbers::pi, 0.01 * 4 * std::numbers::pi);
  EXPECT_NEAR(area[1], std::numbers::pi, 0.01 * std::numbers::pi);
  const FaceTable faces(scene, 32);
  EXPECT_EQ(faces.object_of(made.mesh.surfaces.back().face), 1U);
}

TEST(UniformElements, DuplicateFacesAreLeftOutWithAWarning) {
  const Polygon square = floor_rectangle(0, 1, 0, 1);
  const auto made = make_uniform_elements(polygon_scene({square, square}), {.sides = PatchSides::both});
  EXPECT_EQ(made.mesh.surface_count(), 2U);
  ASSERT_EQ(made.warnings.size(), 1U);
  EXPECT_NE(made.warnings[0].find("exactly on another"), std::string::npos) << made.warnings[0];
}

TEST(UniformElements, SizesThatMakeNoSenseAreRefused) {
  const Scene scene = polygon_scene({floor_rectangle(0, 1, 0, 1)});
  EXPECT_THROW((void)make_uniform_elements(scene, {.element_size = -1}), std::invalid_argument);
  EXPECT_THROW((void)make_uniform_elements(scene, {.element_size = 1e-6}), std::invalid_argument);
  EXPECT_THROW((void)make_uniform_elements(scene, {.element_size = std::nan("")}), std::invalid_argument);
}

// Textures: a picture over the unit square, in float texels so that sums are exact.

Scene textured_square(int width, int height, const std::vector<float>& grey, TexelFilter filter) {
  Scene scene = polygon_scene({floor_rectangle(0, 1, 0, 1)});
  scene.meshes[0].uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  scene.images.push_back({"picture", width, height, 1, grey});
  scene.textures.push_back({0, Wrap::clamp, Wrap::clamp, filter});
  scene.materials[0] = matt(0.5);
  scene.materials[0].base_colour_texture = TextureRef{};
  return scene;
}

TEST(ElementPaint, ElementsTakeTheirOwnPartOfATexture) {
  // Four texels, two by two elements: each has its texel's value; v runs downwards with y here.
  const Scene scene = textured_square(2, 2, {0.2F, 0.4F, 0.6F, 0.8F}, TexelFilter::nearest);
  const PatchMesh mesh = elements_of(scene, 0.5);
  ASSERT_EQ(mesh.patch_count(), 4U);
  for (std::size_t e = 0; e < 4; ++e) {
    const double texel = (mesh.centroids[e].x > 0.5 ? 0.4 : 0.2) + (mesh.centroids[e].y > 0.5 ? 0.4 : 0);
    EXPECT_NEAR(mesh.reflectance[3 * e], 0.5 * texel, 1e-6);
  }
  // One element has the mean.
  EXPECT_NEAR(elements_of(scene, 0).reflectance[0], 0.25, 2e-3);
}

TEST(ElementPaint, AFineCheckerAveragesToItsMeanWhateverTheElements) {
  const int n = 64;
  std::vector<float> checker;
  for (int k = 0; k < n * n; ++k) checker.push_back((k / n + k % n) % 2 == 0 ? 1.0F : 0.0F);
  const Scene scene = textured_square(n, n, checker, TexelFilter::linear);
  for (const double size : {1.0, 0.25}) {
    const PatchMesh mesh = elements_of(scene, size);
    double mean = 0;
    for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
      mean += mesh.reflectance[3 * e] * mesh.areas[e];
      EXPECT_NEAR(mesh.reflectance[3 * e], 0.25, 0.02);
    }
    EXPECT_NEAR(mean, 0.25, 5e-3);
  }
}

TEST(ElementPaint, VertexColoursAreAveragedExactly) {
  Scene scene = polygon_scene({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
  scene.meshes[0].colours = {{0, 0, 0, 1}, {0.9F, 0, 0, 1}, {0, 0.3F, 0.6F, 1}};
  scene.materials[0] = matt(1);
  const PatchMesh mesh = elements_of(scene, 0.5);
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    // Linear over the triangle, so the mean is the value at the centroid.
    EXPECT_NEAR(mesh.reflectance[3 * e + 0], 0.9 * mesh.centroids[e].x, 1e-6);
    EXPECT_NEAR(mesh.reflectance[3 * e + 1], 0.3 * mesh.centroids[e].y, 1e-6);
    EXPECT_NEAR(mesh.reflectance[3 * e + 2], 0.6 * mesh.centroids[e].y, 1e-6);
  }
}

TEST(ElementPaint, MetalAndGlassTakeTheirShareAndEmissionIsPiL) {
  Scene scene = textured_square(1, 2, {0.25F, 0.75F}, TexelFilter::nearest);
  Material& material = scene.materials[0];
  material = matt(0.8, 2);
  material.metallic = 1;
  material.transmission = 0.5F;
  material.metallic_roughness_texture = material.emission_texture = TextureRef{};
  const PatchMesh mesh = elements_of(scene, 0.5, PatchSides::both);
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    const double texel = mesh.centroids[e].y > 0.5 ? 0.75 : 0.25;
    EXPECT_NEAR(mesh.reflectance[3 * e], 0.8 * (1 - texel) * 0.5, 1e-6);
    EXPECT_NEAR(mesh.emission[3 * e], mesh.surfaces[e].back ? 0 : std::numbers::pi * 2 * texel, 1e-5);
  }
  material.double_sided = true;
  const PatchMesh both = elements_of(scene, 0.5, PatchSides::both);
  for (std::size_t e = 0; e < both.patch_count(); ++e) EXPECT_GT(both.emission[3 * e], 1);
}

TEST(ElementPaint, FacesOfSeveralTrianglesReadTheirTextureThroughout) {
  // A hexagon whose texture coordinate u is its x: the mean over an element is its centroid's.
  Scene scene = polygon_scene({floor_disk(1, 0, 6)});
  for (const Vec3d& p : scene.meshes[0].positions) scene.meshes[0].uv[0].emplace_back(0.5 + 0.25 * p.x, 0.5);
  std::vector<float> ramp;
  for (int k = 0; k < 256; ++k) ramp.push_back((float(k) + 0.5F) / 256);
  scene.images.push_back({"ramp", 256, 1, 1, ramp});
  scene.textures.push_back({});
  scene.materials[0] = matt(1);
  scene.materials[0].base_colour_texture = TextureRef{};
  const PatchMesh mesh = elements_of(scene, 0.4);
  ASSERT_GT(mesh.patch_count(), 6U);
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    EXPECT_NEAR(mesh.reflectance[3 * e], 0.5 + 0.25 * mesh.centroids[e].x, 1e-4);
  }
}

TEST(ElementPaint, UnlitSurfacesNeitherReflectNorEmit) {
  Scene scene = polygon_scene({floor_rectangle(0, 1, 0, 1)});
  scene.materials[0].unlit = true;
  const PatchMesh mesh = elements_of(scene, 0);
  EXPECT_EQ(mesh.reflectance[0], 0);
  EXPECT_EQ(mesh.emission[0], 0);
}

TEST(FaceTable, FindsTheFaceOfATriangle) {
  Scene scene;
  scene.materials.assign(3, Material{});
  add_polygons(scene, "a", {floor_disk(1, 0, 5), floor_rectangle(0, 1, 0, 1)}, 1);
  add_polygons(scene, "b", {floor_rectangle(0, 1, 0, 1, 2)}, 2);
  const FaceTable faces(scene, 0);
  EXPECT_EQ(faces.face_count(), 3U);
  EXPECT_EQ(faces.face_of(0, 2), 0U);
  EXPECT_EQ(faces.face_of(0, 3), 1U);
  EXPECT_EQ(faces.face_of(1, 1), 2U);
  EXPECT_EQ(faces.object_of(2), 1U);
  EXPECT_EQ(faces.material(1), 1U);
  EXPECT_EQ(faces.material(2), 2U);
  EXPECT_EQ(faces.triangles(0).size(), 3U);
  EXPECT_EQ(faces.triangles(1)[1], 4U);
}

}  // namespace
}  // namespace penumbra
