#include "penumbra/baking/lightmap_atlas.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "baking/atlas_scenes.h"
#include "penumbra/baking/lightmap_uv_check.h"
#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/scene/shape_mesh.h"

namespace penumbra {
namespace {

using Corners = std::array<Vec2d, 3>;

Corners texel_corners(const LightmapAtlas& atlas, std::size_t instance, std::size_t triangle) {
  const Mesh& mesh = atlas.scene.meshes[atlas.scene.instances[instance].mesh];
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = Vec2d(mesh.uv[1][mesh.triangles[triangle][k]]) * Vec2d(atlas.width, atlas.height);
  }
  return corners;
}

/// What holds of every atlas.
void expect_sound(const Scene& input, const LightmapAtlas& atlas, int padding) {
  EXPECT_NO_THROW(validate(atlas.scene));
  ASSERT_EQ(atlas.scene.instances.size(), input.instances.size());
  ASSERT_EQ(atlas.first_triangle.size(), input.instances.size() + 1);
  ASSERT_EQ(atlas.chart_of_triangle.size(), input.triangle_count());
  std::set<std::uint32_t> meshes;
  std::size_t number = 0;
  for (std::size_t i = 0; i < input.instances.size(); ++i) {
    EXPECT_TRUE(meshes.insert(atlas.scene.instances[i].mesh).second) << "a mesh of its own";
    EXPECT_EQ(atlas.scene.instances[i].name, input.instances[i].name);
    const Mesh &before = input.meshes[input.instances[i].mesh],
               &after = atlas.scene.meshes[atlas.scene.instances[i].mesh];
    EXPECT_EQ(after.name, before.name);
    EXPECT_EQ(atlas.first_triangle[i], number);
    ASSERT_EQ(after.triangles.size(), before.triangles.size());
    for (std::size_t t = 0; t < before.triangles.size(); ++t, ++number) {
      EXPECT_EQ(after.material_of(t), before.material_of(t));
      const Chart& chart = atlas.charts[atlas.chart_of_triangle[number]];
      EXPECT_EQ(chart.object, i);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = before.triangles[t][k], w = after.triangles[t][k];
        ASSERT_EQ(after.positions[w], before.positions[v]);
        if (!before.normals.empty()) {
          ASSERT_EQ(after.normals[w], before.normals[v]);
        }
        if (!before.uv[0].empty()) {
          ASSERT_EQ(after.uv[0][w], before.uv[0][v]);
        }
        const Vec2d texel = texel_corners(atlas, i, t)[k];
        EXPECT_GE(texel.x, chart.x - 2e-3);
        EXPECT_LE(texel.x, chart.x + chart.width + 2e-3);
        EXPECT_GE(texel.y, chart.y - 2e-3);
        EXPECT_LE(texel.y, chart.y + chart.height + 2e-3);
      }
    }
  }
  // Boxes grown by half the padding neither meet nor leave the atlas.
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(atlas.width) * static_cast<std::size_t>(atlas.height), 0);
  for (const Chart& c : atlas.charts) {
    ASSERT_GE(c.width, 1);
    ASSERT_GE(c.height, 1);
    ASSERT_GE(c.x, padding / 2);
    ASSERT_GE(c.y, padding / 2);
    ASSERT_LE(c.x + c.width + padding / 2, atlas.width);
    ASSERT_LE(c.y + c.height + padding / 2, atlas.height);
    for (int y = c.y - padding / 2; y < c.y + c.height + padding / 2; ++y) {
      for (int x = c.x - padding / 2; x < c.x + c.width + padding / 2; ++x) {
        std::uint8_t& texel = taken[static_cast<std::size_t>(y * atlas.width + x)];
        ASSERT_EQ(texel, 0) << "two charts at " << x << ", " << y;
        texel = 1;
      }
    }
  }
}

TEST(LightmapAtlas, ABoxHasAChartForEachWallOfWholeTexels) {
  const Scene room = scene_of({inside_of_box({4, 2, 3})});
  const LightmapAtlas atlas = make_lightmap_atlas(room, {.texels_per_metre = 16});
  expect_sound(room, atlas, 4);
  ASSERT_EQ(atlas.charts.size(), 6U);
  EXPECT_EQ(atlas.texels_per_metre, 16);
  std::multiset<std::array<int, 2>> sizes;
  for (const Chart& c : atlas.charts) sizes.insert({c.width, c.height});
  const std::multiset<std::array<int, 2>> expected{{64, 48}, {64, 48}, {64, 32}, {64, 32}, {48, 32}, {48, 32}};
  EXPECT_EQ(sizes, expected) << "each lies along its longer side, to the texel";
}

TEST(LightmapAtlas, CornersOfARectangleLieOnCornersOfTexels) {
  const Scene room = scene_of({inside_of_box({0.557, 0.549, 0.56})});
  const LightmapAtlas atlas = make_lightmap_atlas(room, {.size = 256});
  for (std::size_t t = 0; t < 12; ++t) {
    for (const Vec2d& p : texel_corners(atlas, 0, t)) {
      EXPECT_NEAR(p.x, std::round(p.x), 1e-4);
      EXPECT_NEAR(p.y, std::round(p.y), 1e-4);
    }
  }
}

TEST(LightmapAtlas, EveryBuiltinKeepsItsTriangles) {
  for (const char* name : {"cornell-box", "cornell-spheres", "furnace", "box345", "city"}) {
    SCOPED_TRACE(name);
    const Scene scene = tessellated(make_builtin_scene(name));
    expect_sound(scene, make_lightmap_atlas(scene, {.size = 512}), 4);
    expect_sound(scene, make_lightmap_atlas(scene, {.size = 1024, .mip_levels = 4}), 16);
  }
}

TEST(LightmapAtlas, TexelsAreAsLargeEverywhere) {
  const Scene scene = tessellated(make_builtin_scene("cornell-box"));
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 1024});
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    for (std::size_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      const Chart& chart = atlas.charts[atlas.chart_of_triangle[atlas.first_triangle[i] + t]];
      const Corners c = texel_corners(atlas, i, t);
      const double flat = std::abs((c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[1].y - c[0].y) * (c[2].x - c[0].x));
      const Vec3d a = world_corner(scene, i, t, 0);
      const double world = length(cross(world_corner(scene, i, t, 1) - a, world_corner(scene, i, t, 2) - a));
      // Each side is off by up to half a texel, and no more.
      const double rounding = (1 + 0.5 / chart.width) * (1 + 0.5 / chart.height) - 1;
      EXPECT_NEAR(flat / (world * atlas.texels_per_metre * atlas.texels_per_metre), 1, 1.1 * rounding + 1e-3);
    }
  }
}

TEST(LightmapAtlas, AGivenSizeIsUsedAndFilled) {
  const Scene scene = tessellated(make_builtin_scene("cornell-box"));
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 512});
  EXPECT_EQ(std::max(atlas.width, atlas.height), 512);
  double used = 0;
  for (const Chart& c : atlas.charts) used += static_cast<double>(c.width) * c.height;
  EXPECT_GT(used, 0.6 * atlas.width * atlas.height);
}

TEST(LightmapAtlas, ADensityGivesAnAtlasHardlyLargerThanItsCharts) {
  const Scene scene = tessellated(make_builtin_scene("cornell-box"));
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.texels_per_metre = 200});
  EXPECT_EQ(atlas.texels_per_metre, 200);
  EXPECT_EQ(atlas.width % 4, 0);
  EXPECT_EQ(atlas.height % 4, 0);
  double used = 0;
  for (const Chart& c : atlas.charts) used += (c.width + 4.0) * (c.height + 4.0);
  EXPECT_GT(used, 0.7 * atlas.width * atlas.height);
}

TEST(LightmapAtlas, ACutSquareIsOneChartAndACreaseMakesTwo) {
  Mesh flat;
  add_rectangle(flat, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  add_rectangle(flat, {1, 0, 0}, {1, 0, 0}, {0, 1, 0});  // shares an edge by position only
  EXPECT_EQ(make_lightmap_atlas(scene_of({flat}), {.size = 64}).charts.size(), 1U);
  for (const double angle : {0.01, 0.05}) {
    Mesh bent;
    add_rectangle(bent, Vec3d(0), {1, 0, 0}, {0, 1, 0});
    add_rectangle(bent, {1, 0, 0}, {std::cos(angle), 0, std::sin(angle)}, {0, 1, 0});
    // From one triangle others are within half of the angle.
    EXPECT_EQ(make_lightmap_atlas(scene_of({bent}), {.size = 64, .chart_angle = 0.0205}).charts.size(),
              angle < 0.02 ? 1U : 2U)
        << angle;
  }
}

TEST(LightmapAtlas, AWallOnAFloorPartsIt) {
  Mesh floor;
  add_rectangle(floor, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  add_rectangle(floor, {1, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_rectangle(floor, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_EQ(make_lightmap_atlas(scene_of({floor}), {.size = 64}).charts.size(), 3U);
}

TEST(LightmapAtlas, MaterialsHaveChartsOfTheirOwn) {
  Mesh mesh;
  add_rectangle(mesh, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  add_rectangle(mesh, {1, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.materials = {0, 0, 1, 1};
  Scene scene = scene_of({mesh});
  scene.materials.push_back(scene.materials[0]);
  EXPECT_EQ(make_lightmap_atlas(scene, {.size = 64}).charts.size(), 2U);
}

TEST(LightmapAtlas, SidesFollowTheInstance) {
  Mesh mesh;
  mesh.name = "square";
  add_rectangle(mesh, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  Scene scene = scene_of({mesh, mesh});
  scene.instances[1].mesh = 0;  // two of one mesh, one of them twice as large and mirrored
  scene.instances[1].to_world = Mat4d(2.0);
  scene.instances[1].to_world[0][0] = -2;
  scene.instances[1].to_world[3][3] = 1;
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.texels_per_metre = 10});
  expect_sound(scene, atlas, 4);
  ASSERT_EQ(atlas.charts.size(), 2U);
  EXPECT_EQ(atlas.charts[0].width, 10);
  EXPECT_EQ(atlas.charts[1].width, 20);
}

TEST(LightmapAtlas, ValidCoordinatesOfTheInputAreKept) {
  Mesh mesh;
  mesh.name = "square";
  add_rectangle(mesh, Vec3d(0), {2, 0, 0}, {0, 2, 0});
  mesh.uv[1] = {{0.25F, 0.25F}, {0.75F, 0.25F}, {0.75F, 0.75F}, {0.25F, 0.75F}};
  const LightmapAtlas kept = make_lightmap_atlas(scene_of({mesh}), {.size = 64});
  EXPECT_TRUE(kept.from_input);
  EXPECT_EQ(kept.scene.meshes[0].uv[1], mesh.uv[1]);
  EXPECT_EQ(kept.width, 64);
  EXPECT_NEAR(kept.texels_per_metre, 16, 1e-6);
  ASSERT_EQ(kept.charts.size(), 1U);
  EXPECT_EQ(kept.charts[0].x, 16);
  EXPECT_EQ(kept.charts[0].width, 32);
  EXPECT_EQ(make_lightmap_atlas(scene_of({mesh}), {.texels_per_metre = 16}).width, 64);
  EXPECT_FALSE(make_lightmap_atlas(scene_of({mesh}), {.size = 64, .keep_input = false}).from_input);
  mesh.uv[1][2] = {0.25F, 0.25F};
  EXPECT_FALSE(make_lightmap_atlas(scene_of({mesh}), {.size = 64}).from_input);
}

TEST(LightmapAtlas, TexturesThatReadTheSecondSetFindItInTheFirst) {
  Mesh mesh;
  mesh.name = "two";
  add_rectangle(mesh, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  mesh.materials = {0, 1};  // they share two vertices
  mesh.uv[0] = {{1, 1}, {2, 2}, {3, 3}, {4, 4}};
  mesh.uv[1] = {{5, 5}, {6, 6}, {7, 7}, {8, 8}};
  Scene scene = scene_of({mesh});
  scene.materials.push_back(scene.materials[0]);
  scene.images.push_back({.name = "", .width = 1, .height = 1, .channels = 1, .texels = std::vector<std::uint8_t>{9}});
  scene.textures.emplace_back();
  scene.materials[0].base_colour_texture = TextureRef{.texture = 0, .uv_set = 0};
  scene.materials[1].base_colour_texture = TextureRef{.texture = 0, .uv_set = 1};
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 64});
  EXPECT_EQ(atlas.scene.materials[1].base_colour_texture->uv_set, 0U);
  const Mesh& after = atlas.scene.meshes[0];
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(after.uv[0][after.triangles[t][k]], mesh.uv[t][mesh.triangles[t][k]]);
    }
  }
  scene.materials[1].emission_texture = TextureRef{.texture = 0, .uv_set = 0};
  EXPECT_THROW((void)make_lightmap_atlas(scene, {.size = 64}), std::invalid_argument);
}

TEST(LightmapAtlas, TrianglesWithoutAnAreaAreKept) {
  Mesh mesh;
  mesh.name = "with specks";
  add_rectangle(mesh, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  mesh.positions.insert(mesh.positions.end(), {{5, 5, 5}, {5, 5, 5}, {5, 5, 5}, {6, 5, 5}, {7, 5, 5}});
  mesh.triangles.push_back({4, 5, 6});  // a point
  mesh.triangles.push_back({4, 7, 8});  // a line
  mesh.triangles.push_back({0, 1, 1});  // collapsed onto an edge
  add_rectangle(mesh, {9, 9, 9}, {1e-7, 0, 0}, {0, 1e-7, 0});
  const Scene scene = scene_of({mesh});
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 64});
  expect_sound(scene, atlas, 4);
}

TEST(LightmapAtlas, ASphereWidensItsChartsUntilTheyAreMoreThanPadding) {
  const Scene scene = scene_of({unit_sphere_mesh()});
  const LightmapAtlas fine = make_lightmap_atlas(scene, {.size = 2048});
  const LightmapAtlas coarse = make_lightmap_atlas(scene, {.size = 256});
  expect_sound(scene, coarse, 4);
  EXPECT_GT(fine.charts.size(), 1000U);
  EXPECT_LT(coarse.charts.size(), 400U);
  // And no two triangles overlap.
  std::vector<UvTriangle> triangles;
  for (std::size_t t = 0; t < coarse.chart_of_triangle.size(); ++t) triangles.push_back(texel_corners(coarse, 0, t));
  EXPECT_FALSE(find_overlap(triangles, 2e-3).has_value());
}

TEST(LightmapAtlas, AWindingStairDoesNotFoldOverItself) {
  // A ramp of two turns that rises gently: seen from above it covers itself, though each step is nearly level.
  Mesh ramp;
  constexpr std::uint32_t steps = 128;
  for (std::uint32_t i = 0; i <= steps; ++i) {
    const double angle = 4 * std::numbers::pi * i / steps;
    for (const double radius : {1.0, 2.0}) {
      ramp.positions.emplace_back(radius * std::cos(angle), 0.001 * i, -radius * std::sin(angle));
    }
  }
  for (std::uint32_t i = 0; i < steps; ++i) {
    ramp.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    ramp.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  const Scene scene = scene_of({ramp});
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 512, .chart_angle = 0.5});
  std::vector<UvTriangle> triangles;
  for (std::size_t t = 0; t < atlas.chart_of_triangle.size(); ++t) triangles.push_back(texel_corners(atlas, 0, t));
  EXPECT_FALSE(find_overlap(triangles, 0.01).has_value());
  EXPECT_LT(atlas.charts.size(), 40U);
}

TEST(LightmapAtlas, TheSameSceneGivesTheSameAtlas) {
  const Scene scene = tessellated(make_builtin_scene("cornell-spheres"));
  const LightmapAtlas a = make_lightmap_atlas(scene, {.size = 256}), b = make_lightmap_atlas(scene, {.size = 256});
  ASSERT_EQ(a.charts.size(), b.charts.size());
  for (std::size_t m = 0; m < a.scene.meshes.size(); ++m) EXPECT_EQ(a.scene.meshes[m].uv[1], b.scene.meshes[m].uv[1]);
}

TEST(LightmapAtlas, WhatCannotBeIsSaid) {
  const Scene room = scene_of({inside_of_box({1, 1, 1})});
  EXPECT_THROW((void)make_lightmap_atlas(room, {.size = 30}), std::invalid_argument);
  EXPECT_THROW((void)make_lightmap_atlas(room, {.size = -4}), std::invalid_argument);
  EXPECT_THROW((void)make_lightmap_atlas(room, {.size = 64, .texels_per_metre = 10}), std::invalid_argument);
  EXPECT_THROW((void)make_lightmap_atlas(room, {.texels_per_metre = 1e6}), std::invalid_argument);
  EXPECT_THROW((void)make_lightmap_atlas(room, {.size = 64, .mip_levels = 9}), std::invalid_argument);
  EXPECT_THROW((void)make_lightmap_atlas(room, {.size = 8}), std::invalid_argument) << "six charts of 5 texels";
  EXPECT_THROW((void)make_lightmap_atlas(make_builtin_scene("cornell-spheres"), {}), std::invalid_argument)
      << "exact spheres";
  EXPECT_EQ(make_lightmap_atlas(Scene{}, {.size = 64}).charts.size(), 0U);
}

TEST(LightmapAtlas, SlowAMillionFacesInLessThanAMinute) {
  Mesh hills;
  constexpr std::uint32_t n = 708;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      hills.positions.emplace_back(0.1 * x, 0.3 * std::sin(0.05 * x) * std::cos(0.07 * y), -0.1 * y);
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t v = y * (n + 1) + x;
      hills.triangles.push_back({v, v + 1, v + n + 2});
      hills.triangles.push_back({v, v + n + 2, v + n + 1});
    }
  }
  const Scene scene = scene_of({hills});
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 4096});
  EXPECT_EQ(atlas.chart_of_triangle.size(), 2U * n * n);
  EXPECT_LE(std::max(atlas.width, atlas.height), 4096);
}

}  // namespace
}  // namespace penumbra
