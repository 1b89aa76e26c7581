#include "penumbra/baking/lightmap_uv_check.h"

#include <gtest/gtest.h>

#include "baking/atlas_scenes.h"

namespace penumbra {
namespace {

Scene unit_square_with_uv(const std::vector<Vec2f>& uv) {
  Mesh mesh;
  mesh.name = "square";
  add_rectangle(mesh, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  mesh.uv[1] = uv;
  return scene_of({mesh});
}

TEST(LightmapUvCheck, ASquareThatFillsTheTextureIsALightmap) {
  EXPECT_EQ(lightmap_uv_fault(unit_square_with_uv({{0, 0}, {1, 0}, {1, 1}, {0, 1}})), std::nullopt);
  EXPECT_EQ(lightmap_uv_fault(unit_square_with_uv({{0, 1}, {1, 1}, {1, 0}, {0, 0}})), std::nullopt) << "mirrored";
}

TEST(LightmapUvCheck, WhatIsNoLightmapIsSaid) {
  EXPECT_NE(lightmap_uv_fault(unit_square_with_uv({}))->find("no TEXCOORD_1"), std::string::npos);
  EXPECT_NE(lightmap_uv_fault(unit_square_with_uv({{0, 0}, {1.1F, 0}, {1, 1}, {0, 1}}))->find("beyond"),
            std::string::npos);
  EXPECT_NE(lightmap_uv_fault(unit_square_with_uv({{0, 0}, {1, 0}, {0, 0}, {1, 0}}))->find("no area"),
            std::string::npos);
  EXPECT_NE(lightmap_uv_fault(unit_square_with_uv({{0, 0}, {1, 0}, {1, 1}, {1, 0.5F}}))->find("overlap"),
            std::string::npos)
      << "the second triangle folds back over the first";
}

TEST(LightmapUvCheck, TwoInstancesOfOneMeshShareTheirTexels) {
  Scene scene = unit_square_with_uv({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  scene.instances.push_back(scene.instances[0]);
  EXPECT_NE(lightmap_uv_fault(scene)->find("overlap"), std::string::npos);
}

TEST(FindOverlap, NeighboursInAGridOfAnySizeDoNotOverlapAndOneMovedDoes) {
  for (const int n : {1, 3, 40}) {
    std::vector<UvTriangle> triangles;
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const Vec2d a(x, y);
        triangles.push_back({a, a + Vec2d(1, 0), a + Vec2d(1, 1)});
        triangles.push_back({a, a + Vec2d(1, 1), a + Vec2d(0, 1)});
      }
    }
    EXPECT_FALSE(find_overlap(triangles, 1e-6).has_value()) << n;
    for (Vec2d& p : triangles.back()) p -= Vec2d(-0.01, 0.01);
    EXPECT_TRUE(find_overlap(triangles, 1e-6).has_value()) << n;
    EXPECT_FALSE(find_overlap(triangles, 0.02).has_value()) << n;
  }
}

TEST(FindOverlap, ALargeOneOverManySmallIsFound) {
  std::vector<UvTriangle> triangles;
  for (int i = 0; i < 100; ++i) {
    const Vec2d a(i, 0);
    triangles.push_back({a, a + Vec2d(0.1, 0), a + Vec2d(0, 0.1)});
  }
  EXPECT_FALSE(find_overlap(triangles, 1e-6).has_value());
  triangles.push_back({Vec2d(50.5, -1), Vec2d(51.05, 0.05), Vec2d(50.5, 1)});
  const auto pair = find_overlap(triangles, 1e-6);
  ASSERT_TRUE(pair.has_value());
  EXPECT_EQ((*pair)[0], 51U);
  EXPECT_EQ((*pair)[1], 100U);
}

}  // namespace
}  // namespace penumbra
