#include <array>
#include <numbers>
#include <string_view>

#include "penumbra/math/transform.h"
#include "penumbra/scene/builtin_parts.h"

namespace penumbra {

namespace {

enum Paint : std::uint32_t { red, green, white, lamp };

/// A quadrilateral of the measured box, in the data's millimetres.
struct MeasuredQuad {
  std::string_view name;
  Paint paint;
  std::array<Vec3d, 4> corners;
};

// Cornell University Program of Computer Graphics, "Cornell Box Data" (1998, geometry measured in millimetres).
// The lamp hangs 0.1 mm under the ceiling, so that the two do not coincide. The published corner orders all turn
// counter-clockwise seen from the air of the room (the lamp's: from below); none had to be reversed.
constexpr double h = 548.8;
constexpr double d = 559.2;
const std::array<MeasuredQuad, 6> room{{
    {"floor", white, {{{552.8, 0, 0}, {0, 0, 0}, {0, 0, d}, {549.6, 0, d}}}},
    {"light", lamp, {{{343, 548.7, 227}, {343, 548.7, 332}, {213, 548.7, 332}, {213, 548.7, 227}}}},
    {"ceiling", white, {{{556, h, 0}, {556, h, d}, {0, h, d}, {0, h, 0}}}},
    {"back", white, {{{549.6, 0, d}, {0, 0, d}, {0, h, d}, {556, h, d}}}},
    {"right", green, {{{0, 0, d}, {0, 0, 0}, {0, h, 0}, {0, h, d}}}},
    {"left", red, {{{552.8, 0, 0}, {549.6, 0, d}, {556, h, d}, {556, h, 0}}}},
}};
const std::array<MeasuredQuad, 10> blocks{{
    {"short0", white, {{{130, 165, 65}, {82, 165, 225}, {240, 165, 272}, {290, 165, 114}}}},
    {"short1", white, {{{290, 0, 114}, {290, 165, 114}, {240, 165, 272}, {240, 0, 272}}}},
    {"short2", white, {{{130, 0, 65}, {130, 165, 65}, {290, 165, 114}, {290, 0, 114}}}},
    {"short3", white, {{{82, 0, 225}, {82, 165, 225}, {130, 165, 65}, {130, 0, 65}}}},
    {"short4", white, {{{240, 0, 272}, {240, 165, 272}, {82, 165, 225}, {82, 0, 225}}}},
    {"tall0", white, {{{423, 330, 247}, {265, 330, 296}, {314, 330, 456}, {472, 330, 406}}}},
    {"tall1", white, {{{423, 0, 247}, {423, 330, 247}, {472, 330, 406}, {472, 0, 406}}}},
    {"tall2", white, {{{472, 0, 406}, {472, 330, 406}, {314, 330, 456}, {314, 0, 456}}}},
    {"tall3", white, {{{314, 0, 456}, {314, 330, 456}, {265, 330, 296}, {265, 0, 296}}}},
    {"tall4", white, {{{265, 0, 296}, {265, 330, 296}, {423, 330, 247}, {423, 0, 247}}}},
}};

void add_quad(Scene& scene, const MeasuredQuad& quad) {
  Mesh mesh;
  mesh.name = quad.name;
  mesh.materials = {quad.paint};
  std::array<Vec3d, 4> p = quad.corners;
  for (Vec3d& corner : p) corner /= 1000.0;
  if (quad.paint == red) {
    // The left wall is not planar (3.2 mm): its diagonal is part of the scene, so it is two faces.
    add_face(mesh, std::array{p[0], p[1], p[2]});
    add_face(mesh, std::array{p[0], p[2], p[3]});
  } else {
    add_face(mesh, p);
  }
  add_object(scene, std::move(mesh));
}

Scene cornell_room() {
  Scene scene;
  scene.materials = {lambertian("red", {0.63F, 0.065F, 0.05F}), lambertian("green", {0.14F, 0.45F, 0.091F}),
                     lambertian("white", {0.725F, 0.71F, 0.68F}), lambertian("light", Rgb(0.0F), {17.0F, 12.0F, 4.0F})};
  for (const MeasuredQuad& quad : room) add_quad(scene, quad);
  // Looking along +z with +y up, x grows to the left in the picture: the published view.
  const Vec3d eye(0.278, 0.273, -0.8);
  scene.cameras = {{.name = "camera",
                    .to_world = look_at(eye, eye + Vec3d(0, 0, 1), {0, 1, 0}),
                    .lens = PerspectiveLens{39.3076 * std::numbers::pi / 180}}};
  return scene;
}

}  // namespace

Scene make_cornell_box(const BuiltinParameters&) {
  Scene scene = cornell_room();
  for (const MeasuredQuad& quad : blocks) add_quad(scene, quad);
  return scene;
}

Scene make_cornell_spheres(const BuiltinParameters&) {
  Scene scene = cornell_room();
  Material mirror = lambertian("mirror", Rgb(0.0F));
  mirror.mirror = Rgb(0.95F);
  Material glass;
  glass.name = "glass";
  glass.base_colour = Rgb(1.0F);
  glass.roughness = 0;
  glass.transmission = 1;
  glass.ior = 1.5F;
  scene.shapes = {{.name = "mirror sphere",
                   .shape = Sphere{{0.375, 0.11, 0.385}, 0.11},
                   .material = add_material(scene, std::move(mirror))},
                  {.name = "glass sphere",
                   .shape = Sphere{{0.165, 0.1, 0.185}, 0.1},
                   .material = add_material(scene, std::move(glass))}};
  return scene;
}

}  // namespace penumbra
