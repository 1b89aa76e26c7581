#include "penumbra/scene/lit.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "penumbra/scene/texture_lookup.h"

namespace penumbra {
namespace {

/// One triangle that stands in the scene, with a material of its own.
Scene dark_scene() {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials.emplace_back();
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"wedge", 0, Mat4d(1.0)});
  return scene;
}

/// A white emission texture of `size` x `size` texels of which `lit` are white, the rest black.
void add_emission_texture(Scene& scene, int size, int lit) {
  std::vector<std::uint8_t> texels(static_cast<std::size_t>(size * size) * 3, 0);
  std::fill(texels.begin(), texels.begin() + 3 * lit, 255);
  scene.images.push_back({"glow", size, size, 3, texels});
  scene.textures.push_back({});
  scene.materials[0].emission_texture = TextureRef{};
}

TEST(Lit, NothingShinesByItself) {
  EXPECT_FALSE(is_lit(Scene{}));
  EXPECT_FALSE(is_lit(dark_scene()));
}

TEST(Lit, EnvironmentsAndLightsButNotAmbientOnes) {
  Scene scene = dark_scene();
  scene.lights.push_back({"everywhere", AmbientLight{}});
  EXPECT_FALSE(is_lit(scene));
  scene.lights.push_back({"sun", DirectionalLight{}});
  EXPECT_TRUE(is_lit(scene));
  scene.lights.clear();
  scene.environment = Environment{};
  EXPECT_TRUE(is_lit(scene));
}

TEST(Lit, EmissionCountsOnceItStandsInTheScene) {
  Scene scene = dark_scene();
  scene.materials[1].emission = Rgb(1e-4F);
  EXPECT_FALSE(is_lit(scene)) << "nothing is made of it";
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes[1].materials = {1};
  EXPECT_FALSE(is_lit(scene)) << "no instance shows the mesh";
  scene.instances.push_back({"lamp", 1, Mat4d(1.0)});
  EXPECT_TRUE(is_lit(scene));
  scene.instances.pop_back();
  scene.shapes.push_back({"ball", Sphere{}, 1});
  EXPECT_TRUE(is_lit(scene));
  scene.materials[1].unlit = true;
  EXPECT_FALSE(is_lit(scene)) << "a picture of light is no lamp";
}

TEST(Lit, ATextureMustGlowByATenthOnAverage) {
  Scene scene = dark_scene();
  scene.materials[0].emission = Rgb(1);
  add_emission_texture(scene, 10, 9);
  EXPECT_FALSE(is_lit(scene));
  scene.images.clear();
  scene.textures.clear();
  add_emission_texture(scene, 10, 11);
  EXPECT_TRUE(is_lit(scene));
  scene.materials[0].emission = Rgb(0.5F);
  EXPECT_FALSE(is_lit(scene)) << "the factor counts";
  scene.materials[0].emission = Rgb(0, 1, 0);
  EXPECT_FALSE(is_lit(scene)) << "0.11 of green has luminance 0.079";
}

TEST(Lit, TexelsAreDecodedBeforeTheyAreAveraged) {
  Scene scene = dark_scene();
  scene.materials[0].emission = Rgb(1);
  add_emission_texture(scene, 1, 0);
  scene.images[0].texels = std::vector<std::uint8_t>(3, 80);  // 0.31 encoded, 0.08 linear
  EXPECT_FALSE(is_lit(scene));
  scene.images[0].texels = std::vector<std::uint8_t>(3, 95);  // 0.114 linear
  EXPECT_TRUE(is_lit(scene));
  const Vec4f mean = mean_texel({"two", 2, 1, 1, std::vector<std::uint8_t>{0, 255}}, TexelEncoding::srgb);
  EXPECT_FLOAT_EQ(mean.x, 0.5F);
  EXPECT_FLOAT_EQ(mean.w, 1.0F);
}

}  // namespace
}  // namespace penumbra
