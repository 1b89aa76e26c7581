#include <array>
#include <cmath>
#include <numbers>

#include "penumbra/math/transform.h"
#include "penumbra/scene/builtin_parts.h"

namespace penumbra {

namespace {

/// The still life is given left-handed (the picture's right is +x, the eye looks along +z); ours is its mirror image in
/// x, which a right-handed eye along +z sees the same.
Vec3d mirrored(double x, double y, double z) { return {-x, y, z}; }

void add_sphere(Scene& scene, const Vec3d& centre, double radius, Material material) {
  std::string name = material.name;
  scene.shapes.push_back(
      {.name = std::move(name), .shape = Sphere{centre, radius}, .material = add_material(scene, std::move(material))});
}

void add_floor(Scene& scene) {
  // Squares whose indices sum to an even number are yellow in the left-handed original; mirroring x shifts the
  // indices by one, so there the even squares are red.
  Material floor = lambertian("checkered floor", 0.8F * Rgb(0.8F, 0.1F, 0.1F));
  floor.checker_colour = 0.8F * Rgb(1.0F, 0.9F, 0.1F);
  floor.mirror = Rgb(0.05F);
  scene.shapes.push_back(
      {.name = floor.name, .shape = Plane{{0, 0, 0}, {0, 1, 0}}, .material = add_material(scene, floor)});
}

void add_still_life(Scene& scene) {
  Material glass;
  glass.name = "glass ball";
  glass.base_colour = Rgb(0.95F);
  glass.roughness = 0;
  glass.transmission = 1;
  glass.ior = 1.5F;
  add_sphere(scene, mirrored(-0.6, 1.5, -1.5), 1.0, glass);

  Material mirror = lambertian("mirror ball", 0.1F * Rgb(0.9F));
  mirror.mirror = Rgb(0.85F);
  add_sphere(scene, mirrored(1.2, 1.0, 0.8), 1.0, mirror);

  Material glossy;
  glossy.name = "glossy ball";
  glossy.base_colour = 0.8F * Rgb(0.2F, 0.4F, 0.9F);
  glossy.roughness = 0.3F;
  add_sphere(scene, mirrored(-2.4, 0.8, 1.5), 0.8, glossy);

  add_sphere(scene, mirrored(2.7, 0.5, -1.3), 0.5, lambertian("matt ball", 0.8F * Rgb(0.1F, 0.8F, 0.3F)));
}

/// Forty small balls in five rows behind, each of another colour.
void add_marbles(Scene& scene) {
  for (int k = 0; k < 40; ++k) {
    const Rgb colour(static_cast<float>(k % 3) / 2.0F, static_cast<float>(k % 5) / 4.0F,
                     static_cast<float>(k % 7) / 6.0F);
    Material marble = lambertian("marble " + std::to_string(k + 1), 0.7F * colour);
    marble.mirror = Rgb(0.2F);
    const int row = k / 8;
    const int column = k % 8;
    add_sphere(scene, mirrored(-5.0 + 1.4 * column, 0.25, 3.0 + 1.2 * row), 0.25, std::move(marble));
  }
}

}  // namespace

Scene make_whitted(const BuiltinParameters&) {
  Scene scene;
  add_floor(scene);
  add_still_life(scene);
  add_marbles(scene);
  // Whitted 1979 knows no falloff with distance, and a constant ambient term.
  const PointLight key{.position = mirrored(-6, 8, -5), .intensity = Rgb(0.9F), .inverse_square = false};
  const PointLight fill{.position = mirrored(5, 6, -6), .intensity = Rgb(0.5F), .inverse_square = false};
  scene.lights = {{"key light", key}, {"fill light", fill}, {"ambient", AmbientLight{Rgb(0.1F)}}};
  scene.environment = Environment{.radiance = {0.35F, 0.55F, 0.85F}, .image = {}, .backdrop_only = true};
  // 50 degrees across a picture of 4 : 3.
  const double vertical_fov = 2 * std::atan(std::tan(25 * std::numbers::pi / 180) * 3 / 4);
  scene.cameras = {{.name = "camera",
                    .to_world = look_at(mirrored(0, 2.2, -7), mirrored(0, 1, 0), {0, 1, 0}),
                    .lens = PerspectiveLens{vertical_fov}}};
  return scene;
}

}  // namespace penumbra
