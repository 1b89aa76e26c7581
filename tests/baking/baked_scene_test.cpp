#include "penumbra/baking/baked_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include "baking/atlas_scenes.h"
#include "penumbra/image/tonemap.h"
#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/scene/shape_mesh.h"
#include "penumbra/scene/texture_lookup.h"

namespace penumbra {
namespace {

struct Bake {
  LightmapAtlas atlas;
  Texels texels;
  AtlasLight light;
};

/// The scene in a light that only depends on the place.
Bake lit(const Scene& scene, double (*irradiance)(const Vec3d&), int size = 128) {
  LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = size});
  Texels texels = make_texels(atlas);
  std::vector<float> light;
  for (const Vec3d& p : texels.positions) {
    for (int b = 0; b < 3; ++b) light.push_back(static_cast<float>(irradiance(p)));
  }
  AtlasLight picture = make_atlas_light(atlas, texels, light);
  return {std::move(atlas), std::move(texels), std::move(picture)};
}

BakedScene baked(const Scene& scene, double (*irradiance)(const Vec3d&), BakeProfile profile, double exposure = 0) {
  Bake b = lit(scene, irradiance);
  if (profile != BakeProfile::lightmap) turn_into_radiance(b.light, b.atlas, b.texels);
  fill_gaps(b.light);
  return baked_scene(std::move(b.atlas), std::move(b.light), profile, exposure);
}

Scene coloured_room() {
  Scene scene = scene_of({inside_of_box({1, 2, 3})});
  scene.materials[0].base_colour = {0.25F, 0.5F, 0.75F};
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].name = "lamp";
  scene.materials[1].emission = {4, 3, 2};
  scene.materials[1].base_colour = Rgb(0);
  scene.meshes[0].materials.assign(12, 0);
  scene.meshes[0].materials[2] = scene.meshes[0].materials[3] = 1;
  scene.lights.push_back({.name = "point", .kind = PointLight{}});
  return scene;
}

Rgb seen(const BakedScene& b, const TextureRef& ref, const Vec2f& uv) {
  const Texture& texture = b.scene.textures[ref.texture];
  return Rgb(texture_value(texture, b.scene.images[texture.image], uv, TexelEncoding::srgb));
}

double evenly(const Vec3d&) { return std::numbers::pi; }

void expect_same_objects(const Scene& before, const Scene& after) {
  ASSERT_EQ(after.materials.size(), before.materials.size());
  for (std::size_t m = 0; m < after.materials.size(); ++m) {
    EXPECT_EQ(after.materials[m].name, before.materials[m].name);
    EXPECT_EQ(after.materials[m].double_sided, before.materials[m].double_sided);
  }
  ASSERT_EQ(after.instances.size(), before.instances.size());
  EXPECT_EQ(after.triangle_count(), before.triangle_count());
  EXPECT_TRUE(after.lights.empty());
  EXPECT_NO_THROW(validate(after));
}

TEST(BakedScene, UnlitShowsAlbedoTimesLightAndLampsAsTheyShine) {
  const Scene scene = coloured_room();
  for (const double exposure : {0.0, -2.0}) {
    const BakedScene b = baked(scene, evenly, BakeProfile::unlit, exposure);
    expect_same_objects(scene, b.scene);
    const float scale = static_cast<float>(std::exp2(exposure));
    const Mesh& mesh = b.scene.meshes[0];
    EXPECT_TRUE(mesh.uv[1].empty());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Material& m = b.scene.materials[mesh.material_of(t)];
      EXPECT_TRUE(m.unlit);
      EXPECT_EQ(m.metallic, 0);
      EXPECT_EQ(m.roughness, 1);
      const bool lamp = mesh.material_of(t) == 1;
      const Rgb expected = glm::min(scale * (lamp ? Rgb(4, 3, 2) : Rgb(0.25F, 0.5F, 0.75F)), Rgb(1));
      // Corners too: what lies beside a chart is its own.
      for (const std::uint32_t v : mesh.triangles[t]) {
        const Rgb colour = seen(b, *m.base_colour_texture, mesh.uv[0][v]);
        for (int band = 0; band < 3; ++band) EXPECT_NEAR(colour[band], expected[band], 0.006) << t;
      }
    }
  }
}

TEST(BakedScene, HdrCutsNothing) {
  const Scene scene = coloured_room();
  const BakedScene b = baked(scene, evenly, BakeProfile::hdr, 1);
  expect_same_objects(scene, b.scene);
  const Mesh& mesh = b.scene.meshes[0];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Material& m = b.scene.materials[mesh.material_of(t)];
    EXPECT_EQ(m.base_colour, Rgb(0));
    EXPECT_EQ(m.specular, 0);
    const bool lamp = mesh.material_of(t) == 1;
    const Rgb expected = 2.0F * (lamp ? Rgb(4, 3, 2) : Rgb(0.25F, 0.5F, 0.75F));
    for (const std::uint32_t v : mesh.triangles[t]) {
      const Rgb shown = m.emission * seen(b, *m.emission_texture, mesh.uv[0][v]);
      for (int band = 0; band < 3; ++band) EXPECT_NEAR(shown[band] / expected[band], 1, 0.012) << t;
    }
  }
}

TEST(BakedScene, LightmapLeavesMaterialsAndHoldsIrradiance) {
  Scene scene = coloured_room();
  scene.meshes[0].uv[0].assign(scene.meshes[0].positions.size(), Vec2f(0.5F));
  const BakedScene b = baked(
      scene, [](const Vec3d& p) { return 1 + p.x + p.y; }, BakeProfile::lightmap);
  expect_same_objects(scene, b.scene);
  EXPECT_EQ(b.scene.materials[1].emission, scene.materials[1].emission);
  EXPECT_EQ(b.scene.materials[0].base_colour, scene.materials[0].base_colour);
  ASSERT_TRUE(b.lightmap.has_value());
  EXPECT_NEAR(b.lightmap_strength, 4, 0.1);
  const Mesh& mesh = b.scene.meshes[0];
  for (const Vec2f& uv : mesh.uv[0]) EXPECT_EQ(uv, Vec2f(0.5F));
  for (const Mesh::Triangle& t : mesh.triangles) {
    const Vec3d middle = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0;
    const Vec2f uv = (mesh.uv[1][t[0]] + mesh.uv[1][t[1]] + mesh.uv[1][t[2]]) / 3.0F;
    const Rgb light = b.lightmap_strength * seen(b, {.texture = *b.lightmap}, uv);
    EXPECT_NEAR(light.x, 1 + middle.x + middle.y, 0.05);
  }
}

TEST(BakedScene, TexturesAreMultipliedInWhereTheyLie) {
  // Left half black, right half white, by a texture of two texels.
  Mesh mesh;
  mesh.name = "square";
  add_rectangle(mesh, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  mesh.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  Scene scene = scene_of({mesh});
  scene.images.push_back({.name = "halves",
                          .width = 2,
                          .height = 1,
                          .channels = 3,
                          .texels = std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255}});
  scene.textures.push_back({.image = 0, .wrap_u = Wrap::clamp, .wrap_v = Wrap::clamp, .filter = TexelFilter::nearest});
  scene.materials[0].base_colour = Rgb(1);
  scene.materials[0].base_colour_texture = TextureRef{.texture = 0};
  const BakedScene b = baked(scene, evenly, BakeProfile::unlit);
  const Mesh& after = b.scene.meshes[0];
  const TextureRef& ref = *b.scene.materials[0].base_colour_texture;
  const auto at = [&](double x, double y) {  // of the square, by its corners' coordinates
    const Vec2f uv = after.uv[0][0] + static_cast<float>(x) * (after.uv[0][1] - after.uv[0][0]) +
                     static_cast<float>(y) * (after.uv[0][3] - after.uv[0][0]);
    return seen(b, ref, uv).x;
  };
  for (const double y : {0.0, 0.5, 1.0}) {
    EXPECT_NEAR(at(0.0, y), 0, 1e-6);
    EXPECT_NEAR(at(0.45, y), 0, 1e-6);
    EXPECT_NEAR(at(0.55, y), 1, 1e-6);
    EXPECT_NEAR(at(1.0, y), 1, 1e-6);
  }
  // At the cut a texel holds the mean.
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += at((i + 0.5) / 1000, 0.5) / 1000;
  EXPECT_NEAR(sum, 0.5, 0.003);
}

TEST(BakedScene, MetalAndGlassReflectNothingDiffusely) {
  Scene scene = scene_of({inside_of_box({1, 1, 1})});
  for (const bool metal : {true, false}) {
    scene.materials[0].metallic = metal ? 1.0F : 0.0F;
    scene.materials[0].transmission = metal ? 0.0F : 1.0F;
    const BakedScene b = baked(scene, evenly, BakeProfile::unlit);
    for (const std::uint8_t c : std::get<std::vector<std::uint8_t>>(b.scene.images[0].texels)) ASSERT_EQ(c, 0);
  }
}

TEST(BakedScene, AlphaComesAlong) {
  Scene scene = scene_of({inside_of_box({1, 1, 1})});
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].alpha = 0.5F;
  for (const BakeProfile profile : {BakeProfile::unlit, BakeProfile::hdr}) {
    const BakedScene b = baked(scene, evenly, profile);
    EXPECT_EQ(b.scene.materials[0].alpha_mode, AlphaMode::blend);
    ASSERT_TRUE(b.scene.materials[0].base_colour_texture.has_value());
    ASSERT_EQ(b.scene.images[0].channels, 4);
    const auto& texels = std::get<std::vector<std::uint8_t>>(b.scene.images[0].texels);
    for (std::size_t i = 3; i < texels.size(); i += 4) ASSERT_EQ(texels[i], 128);
  }
}

}  // namespace
}  // namespace penumbra
