#include "penumbra/baking/texels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "baking/atlas_scenes.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/scene/shape_mesh.h"

namespace penumbra {
namespace {

std::size_t instance_of(const LightmapAtlas& atlas, std::uint32_t triangle) {
  std::size_t i = 0;
  while (atlas.first_triangle[i + 1] <= triangle) ++i;
  return i;
}

/// Distance of a point from a triangle's plane, and how far it lies outside, by its smallest weight.
struct Place {
  double distance = 0, smallest_weight = 0;
  Vec2d texel{0};
  Vec3d front{0};
};
Place place_on(const LightmapAtlas& atlas, std::uint32_t triangle, const Vec3d& p) {
  const std::size_t i = instance_of(atlas, triangle);
  const std::size_t local = triangle - atlas.first_triangle[i];
  const Vec3d a = world_corner(atlas.scene, i, local, 0), b = world_corner(atlas.scene, i, local, 1),
              c = world_corner(atlas.scene, i, local, 2);
  const Vec3d n = cross(b - a, c - a);
  const double area = dot(n, n);
  const double wb = dot(cross(p - a, c - a), n) / area, wc = dot(cross(b - a, p - a), n) / area;
  const Mesh& mesh = atlas.scene.meshes[atlas.scene.instances[i].mesh];
  const Mesh::Triangle& t = mesh.triangles[local];
  const Vec2d uv =
      (1 - wb - wc) * Vec2d(mesh.uv[1][t[0]]) + wb * Vec2d(mesh.uv[1][t[1]]) + wc * Vec2d(mesh.uv[1][t[2]]);
  const double side = is_mirroring(atlas.scene.instances[i].to_world) ? -1 : 1;
  return {std::abs(dot(p - a, n)) / std::sqrt(area), std::min({wb, wc, 1 - wb - wc}),
          uv * Vec2d(atlas.width, atlas.height), side * normalize(n)};
}

void expect_on_their_triangles(const LightmapAtlas& atlas, const Texels& texels) {
  ASSERT_EQ(texels.positions.size(), texels.count());
  for (std::size_t i = 0; i < texels.count(); ++i) {
    const Place place = place_on(atlas, texels.triangles[i], texels.positions[i]);
    ASSERT_LT(place.distance, 1e-9);
    ASSERT_GT(place.smallest_weight, -1e-9);
    ASSERT_LT(length(place.front - texels.normal(i)), 1e-9);
    ASSERT_GT(dot(texels.shading_normal(i), texels.normal(i)), 0);
    // Where the texel's square is, or the centre itself.
    const Vec2d centre(texels.pixels[i] % static_cast<std::uint32_t>(texels.width) + 0.5,
                       texels.pixels[i] / static_cast<std::uint32_t>(texels.width) + 0.5);
    ASSERT_LT(glm::length(place.texel - centre), std::sqrt(0.5) + 2e-3);
  }
}

TEST(Texels, ARectangleHasAsManyAsItsTexelsAndTheirCentresAreItsPoints) {
  const Scene room = scene_of({inside_of_box({4, 2, 3})});
  const LightmapAtlas atlas = make_lightmap_atlas(room, {.texels_per_metre = 16});
  const Texels texels = make_texels(atlas);
  EXPECT_EQ(texels.count(), 2U * (64 * 48 + 64 * 32 + 48 * 32));
  expect_on_their_triangles(atlas, texels);
  double area = 0;
  for (std::size_t i = 0; i < texels.count(); ++i) {
    const Vec2d centre(texels.pixels[i] % static_cast<std::uint32_t>(texels.width) + 0.5,
                       texels.pixels[i] / static_cast<std::uint32_t>(texels.width) + 0.5);
    ASSERT_LT(glm::length(place_on(atlas, texels.triangles[i], texels.positions[i]).texel - centre), 1e-3);
    area += texels.footprint(i) * texels.footprint(i);
  }
  EXPECT_NEAR(area, 52, 52 * 1e-5) << "of the walls, m^2";
}

TEST(Texels, EveryChartHasOneAndNoneIsOfTwoCharts) {
  for (const char* name : {"cornell-box", "cornell-spheres"}) {
    SCOPED_TRACE(name);
    const Scene scene = tessellated(make_builtin_scene(name));
    const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 256});
    const Texels texels = make_texels(atlas);
    expect_on_their_triangles(atlas, texels);
    std::set<std::uint32_t> charts;
    for (std::size_t i = 0; i < texels.count(); ++i) {
      const std::uint32_t chart = atlas.chart_of_triangle[texels.triangles[i]];
      charts.insert(chart);
      const Chart& box = atlas.charts[chart];
      const int x = static_cast<int>(texels.pixels[i]) % texels.width,
                y = static_cast<int>(texels.pixels[i]) / texels.width;
      ASSERT_TRUE(x >= box.x && x < box.x + box.width && y >= box.y && y < box.y + box.height);
      ASSERT_TRUE(i == 0 || texels.pixels[i - 1] < texels.pixels[i]);
    }
    EXPECT_EQ(charts.size(), atlas.charts.size());
  }
}

TEST(Texels, OneThatATriangleOnlyTouchesTakesItsNearestPoint) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.uv[1] = {{0, 0}, {1, 0}, {0, 1}};
  const LightmapAtlas atlas = make_lightmap_atlas(scene_of({mesh}), {.size = 4});
  ASSERT_TRUE(atlas.from_input);
  const Texels texels = make_texels(atlas);
  ASSERT_EQ(texels.count(), 10U) << "those on the diagonal are cut in half, the rest is not met";
  for (std::size_t i = 0; i < texels.count(); ++i) {
    const Vec2d centre(texels.pixels[i] % 4 + 0.5, texels.pixels[i] / 4 + 0.5);
    EXPECT_LT(length(texels.positions[i] - Vec3d(0.25 * centre, 0)), 1e-7) << "each centre is in or on the edge";
  }
  // Moved a quarter of a texel: now the diagonal's centres are outside, and their points are on the edge.
  mesh.uv[1] = {{0.25F, 0.25F}, {0.9375F, 0.25F}, {0.25F, 0.9375F}};
  const LightmapAtlas moved = make_lightmap_atlas(scene_of({mesh}), {.size = 4});
  const Texels others = make_texels(moved);
  ASSERT_EQ(others.count(), 6U);
  for (std::size_t i = 0; i < others.count(); ++i) {
    const Vec2d uv = Vec2d(others.pixels[i] % 4 + 0.5, others.pixels[i] / 4 + 0.5) * 0.25;
    Vec2d weights = (uv - Vec2d(0.25)) / 0.6875;
    const double beyond = weights.x + weights.y - 1;
    if (beyond > 0) weights -= Vec2d(0.5 * beyond);
    EXPECT_LT(length(others.positions[i] - Vec3d(weights, 0)), 1e-6);
  }
}

TEST(Texels, ThinAndFlatTrianglesHaveTexelsToo) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-6, 0}, {0, 5, 0}, {1, 5, 0}, {2, 5, 0}, {9, 9, 9}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 6, 6}};
  const LightmapAtlas atlas = make_lightmap_atlas(scene_of({mesh}), {.texels_per_metre = 8});
  const Texels texels = make_texels(atlas);
  std::array<int, 3> count{};
  for (const std::uint32_t t : texels.triangles) ++count[t];
  EXPECT_EQ(count[0], 8);
  EXPECT_EQ(count[1], 16);
  EXPECT_EQ(count[2], 1);
  for (const Vec3d& n : texels.normals_of) EXPECT_NEAR(length(n), 1, 1e-9);
  for (const double f : texels.footprints_of) EXPECT_TRUE(std::isfinite(f));
}

TEST(Texels, ThreadedAndAloneAreTheSame) {
  const LightmapAtlas atlas = make_lightmap_atlas(tessellated(make_builtin_scene("cornell-spheres")), {.size = 256});
  const Texels many = make_texels(atlas);
  const ThreadLimit limit(1);
  const Texels one = make_texels(atlas);
  EXPECT_EQ(many.pixels, one.pixels);
  EXPECT_EQ(many.triangles, one.triangles);
  EXPECT_EQ(many.positions, one.positions);
}

}  // namespace
}  // namespace penumbra
