#include "penumbra/tracing/shading/surface_material.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/tracing/opacity.h"

namespace penumbra {
namespace {

/// A scene of one material, whose textures are single texels.
struct OneMaterial {
  Scene scene;
  SurfacePoint point;

  OneMaterial() { scene.materials.emplace_back(); }
  Material& material() { return scene.materials[0]; }
  TextureRef add_texel(std::vector<std::uint8_t> texel) {
    const int channels = static_cast<int>(texel.size());
    scene.images.push_back({"", 1, 1, channels, std::move(texel)});
    scene.textures.push_back({static_cast<std::uint32_t>(scene.images.size() - 1), Wrap::repeat, Wrap::repeat, {}});
    return {static_cast<std::uint32_t>(scene.textures.size() - 1), 0, Mat3f(1)};
  }
  SurfaceMaterial read() const { return surface_material(scene, point); }
};

double linear(double code) {
  const double x = code / 255;
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

void expect_colour(const Rgb& value, double r, double g, double b) {
  EXPECT_NEAR(value.x, r, 1e-6);
  EXPECT_NEAR(value.y, g, 1e-6);
  EXPECT_NEAR(value.z, b, 1e-6);
}

TEST(SurfaceMaterial, BaseColourIsFactorTimesVertexTimesTexture) {
  OneMaterial one;
  one.material().base_colour = {0.5F, 0.6F, 0.7F};
  one.point.colour = {0.9F, 0.8F, 0.5F, 1};
  one.material().base_colour_texture = one.add_texel({200, 100, 50});
  expect_colour(one.read().base_colour, 0.45 * linear(200), 0.48 * linear(100), 0.35 * linear(50));
}

TEST(SurfaceMaterial, BaseColourStaysAReflectance) {
  OneMaterial one;
  one.material().base_colour = {1, 0.5F, 0};
  one.point.colour = {3, 1, 1, 1};
  expect_colour(one.read().base_colour, 1, 0.5, 0);
}

TEST(SurfaceMaterial, AlphaIsSeenInBlendModeOnly) {
  OneMaterial one;
  one.material().alpha = 0.5F;
  one.point.colour.w = 0.5F;
  one.material().base_colour_texture = one.add_texel({255, 255, 255, 51});
  EXPECT_EQ(one.read().alpha, 1);
  one.material().alpha_mode = AlphaMode::mask;
  EXPECT_EQ(one.read().alpha, 1);
  one.material().alpha_mode = AlphaMode::blend;
  EXPECT_NEAR(one.read().alpha, 0.05, 1e-6);
  EXPECT_NEAR(surface_alpha(one.scene, one.material(), one.point.uv, 0.5F), 0.05, 1e-6);
}

TEST(SurfaceMaterial, FactorsTakeTheChannelsThatGltfNames) {
  OneMaterial one;
  Material& m = one.material();
  m.roughness = 0.5F;
  m.metallic = 0.8F;
  m.transmission = 0.9F;
  m.specular = 0.7F;
  m.specular_colour = {0.5F, 1, 2};
  m.emission = {10, 20, 30};
  m.metallic_roughness_texture = one.add_texel({1, 102, 204});
  m.transmission_texture = one.add_texel({51, 2, 3});
  m.specular_texture = one.add_texel({1, 2, 3, 153});
  m.specular_colour_texture = one.add_texel({188, 100, 30, 7});
  m.emission_texture = one.add_texel({255, 128, 0});
  const SurfaceMaterial s = one.read();
  EXPECT_NEAR(s.roughness, 0.5 * 0.4, 1e-6);
  EXPECT_NEAR(s.metallic, 0.8 * 0.8, 1e-6);
  EXPECT_NEAR(s.transmission, 0.9 * 0.2, 1e-6);
  EXPECT_NEAR(s.specular, 0.7 * 0.6, 1e-6);
  expect_colour(s.specular_colour, 0.5 * linear(188), linear(100), 2 * linear(30));
  expect_colour(s.emission, 10, 20 * linear(128), 0);
}

TEST(SurfaceMaterial, UnlitShinesInItsBaseColourAndReflectsNothing) {
  OneMaterial one;
  Material& m = one.material();
  m.unlit = true;
  m.base_colour = {0.25F, 0.5F, 0.75F};
  m.metallic = m.transmission = 1;
  m.mirror = Rgb(1);
  m.emission = Rgb(5);
  m.conductor = ConductorIor{};
  const SurfaceMaterial s = one.read();
  expect_colour(s.emission, 0.25, 0.5, 0.75);
  expect_colour(s.base_colour, 0, 0, 0);
  expect_colour(s.mirror, 0, 0, 0);
  EXPECT_EQ(s.metallic + s.transmission + s.specular, 0);
  EXPECT_FALSE(s.conductor);
}

TEST(SurfaceMaterial, ChequersAlternateOverThePlaneOfTheSurface) {
  OneMaterial one;
  one.material().base_colour = Rgb(1);
  one.material().checker_colour = Rgb(0);
  one.material().checker_size = 0.5F;
  for (int axis = 0; axis < 3; ++axis) {
    one.point.geometric_normal = Vec3d(0);
    one.point.geometric_normal[axis] = axis == 1 ? -1 : 1;
    for (int i = -3; i < 3; ++i) {
      for (int j = -3; j < 3; ++j) {
        one.point.position[axis] = 1e-9 * (i - j);  // rounding across the plane must not speckle it
        one.point.position[(axis + 1) % 3] = 0.5 * i + 0.1;
        one.point.position[(axis + 2) % 3] = 0.5 * j + 0.4;
        EXPECT_EQ(one.read().base_colour.x, (i + j) % 2 == 0 ? 1 : 0) << axis << ' ' << i << ' ' << j;
      }
    }
  }
}

TEST(SurfaceMaterial, NormalMapsTiltTowardsTangentAndBitangent) {
  OneMaterial one;
  one.point.geometric_normal = one.point.shading_normal = {0, 1, 0};
  one.point.tangent = {1, 0, 0};
  one.point.bitangent = {0, 0, -1};
  one.material().normal_texture = one.add_texel({255, 128, 255});  // 45 degrees towards +tangent
  const Vec3d tilted = one.read().shading.normal;
  EXPECT_NEAR(tilted.x, tilted.y, 1e-6);
  EXPECT_NEAR(glm::length(tilted), 1, 1e-9);
  EXPECT_NEAR(tilted.z, 0, 0.004);
  one.material().normal_scale = 0.5F;
  const Vec3d half = one.read().shading.normal;
  EXPECT_NEAR(half.x / half.y, 0.5, 1e-6);
  one.material().normal_texture = one.add_texel({128, 255, 255});
  EXPECT_LT(one.read().shading.normal.z, -0.4);
}

TEST(SurfaceMaterial, NormalMapsNeverTurnBehindTheGeometry) {
  OneMaterial one;
  one.material().normal_texture = one.add_texel({0, 128, 0});
  EXPECT_EQ(one.read().shading.normal, one.point.shading_normal);
  one.material().normal_texture = one.add_texel({128, 128, 128});
  one.material().normal_scale = 0;
  const Vec3d n = one.read().shading.normal;
  EXPECT_NEAR(glm::length(n), 1, 1e-9);
  EXPECT_GT(glm::dot(n, one.point.geometric_normal), 0);
}

TEST(FrameTowards, LetsTheEyeSeeTheFrontAndStaysOnTheGeometrysSide) {
  CounterRng rng(1);
  int bent = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto next = [&] {
      const double u = rng.next();
      return sample_sphere({u, rng.next()});
    };
    const Vec3d geometric = next();
    Vec3d normal = next();
    if (glm::dot(normal, geometric) < 0) normal = -normal;
    const Vec3d wo = next();
    const double side = glm::dot(wo, geometric) > 0 ? 1 : -1;
    const Frame frame = frame_towards(Frame(normal), geometric, wo);
    EXPECT_NEAR(glm::length(frame.normal), 1, 1e-12);
    EXPECT_GT(glm::dot(frame.normal, wo) * side, 0);
    EXPECT_GT(glm::dot(frame.normal, geometric), 0);
    if (glm::dot(normal, wo) * side > 0.01) {
      EXPECT_EQ(frame.normal, normal);
    } else {
      ++bent;
    }
  }
  EXPECT_GT(bent, 100);
}

}  // namespace
}  // namespace penumbra
