// Normal maps in pictures: what the light of a sun makes of them.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

// A texel that leans 45 degrees along +u, or along texture-space up, on a floor that is turned about its normal, seen
// from above: the sun's cosine is that of the bent normal.
TEST(NormalMap, LeansWithItsTexture) {
  for (const bool along_u : {true, false}) {
    for (const double turn : {0.0, 0.7, 2.5}) {
      Scene scene;
      const auto lean = static_cast<std::uint8_t>(128 + std::lround(127 * std::sqrt(0.5)));
      TextureImage image{"lean", 1, 1, 3, {}};
      image.texels = along_u ? std::vector<std::uint8_t>{lean, 128, lean} : std::vector<std::uint8_t>{128, lean, lean};
      scene.images.push_back(image);
      scene.textures.push_back({.image = 0});
      Material material = matt(Rgb(0.5F));
      material.normal_texture = TextureRef{.texture = 0};
      // u along +x and v, which grows downwards in the picture, along +z.
      Mesh mesh;
      mesh.positions = {{-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}};
      mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
      mesh.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
      add_mesh(scene, mesh, material);
      scene.instances[0].to_world = glm::rotate(Mat4d(1.0), turn, Vec3d(0, 1, 0));
      DirectionalLight sun;
      sun.direction = normalize(Vec3d(-0.6, -1, 0.35));
      sun.irradiance = Rgb(3);
      scene.lights.push_back({"", sun});
      const RayTracer tracer(scene);
      const Vec3d leaning = transform_vector(scene.instances[0].to_world, along_u ? Vec3d(1, 0, 0) : Vec3d(0, 0, -1));
      const Vec3d normal = normalize(leaning + Vec3d(0, 1, 0));
      const double truth = 0.5 / pi * 3 * std::max(0.0, -dot(normal, sun.direction));
      for (const RenderOptions& options : {whitted(1), path(4)}) {
        EXPECT_NEAR(look(tracer, {0.3, 2, 0.2}, {0, -1, 0}, options).value, truth, 0.01) << along_u << " " << turn;
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
