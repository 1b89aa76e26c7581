// Scenes for light that has wavelengths: a prism, a rainbow, dyes under violet light.

#include <array>
#include <cmath>
#include <numbers>

#include "penumbra/math/dispersion.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/builtin_parts.h"

namespace penumbra {

namespace {

// Coefficients of Schott's catalogue.
constexpr Sellmeier dense_flint{{1.62153902, 0.256287842, 1.64447552}, {0.0122241457, 0.0595736775, 147.468793}};

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Material clear(std::string name, const Dispersion& dispersion) {
  Material glass;
  glass.name = std::move(name);
  glass.base_colour = Rgb(1.0F);
  glass.roughness = 0;
  glass.transmission = 1;
  glass.ior = static_cast<float>(refractive_index(dispersion, line_d));
  glass.dispersion = dispersion;
  return glass;
}

void add_quad(Scene& scene, std::string name, const std::array<Vec3d, 4>& corners, Material material) {
  Mesh mesh;
  mesh.name = std::move(name);
  mesh.materials = {add_material(scene, std::move(material))};
  add_face(mesh, corners);
  add_object(scene, std::move(mesh));
}

/// A right prism that stands on y = 0, its section an equilateral triangle with one edge towards -x, that far from the
/// axis of y as `apex` says.
Mesh prism_mesh(double side, double height, double apex) {
  std::array<Vec3d, 3> foot;
  for (int k = 0; k < 3; ++k) {
    const double turn = radians(180 + 120.0 * k);
    const double radius = side / std::sqrt(3.0);
    foot[static_cast<std::size_t>(k)] = radius * Vec3d(std::cos(turn), 0, std::sin(turn)) + Vec3d(radius - apex, 0, 0);
  }
  const Vec3d up(0, height, 0);
  Mesh mesh;
  mesh.name = "prism";
  add_face(mesh, std::array{foot[0], foot[1], foot[2]});
  add_face(mesh, std::array{foot[2] + up, foot[1] + up, foot[0] + up});
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &a = foot[k], &b = foot[(k + 1) % 3];
    add_face(mesh, std::array{b, a, a + up, b + up});
  }
  return mesh;
}

/// A vertical strip of light from half a metre below a place to as much above, at a distance, facing it.
/// @param turn from -z towards +x, rad.
void add_strip_lamp(Scene& scene, const Vec3d& before, double turn, double distance, double half_width,
                    float radiance) {
  const Vec3d away(std::sin(turn), 0, -std::cos(turn));
  const Vec3d along = half_width * Vec3d(std::cos(turn), 0, std::sin(turn));
  const Vec3d foot = before + distance * away - Vec3d(0, 0.5, 0), up(0, 1, 0);
  add_quad(scene, "strip lamp", {foot - along, foot + along, foot + along + up, foot - along + up},
           lambertian("strip lamp", Rgb(0.0F), Rgb(radiance)));
}

/// White light through a slit towards a prism's face, and the screen that it falls on.
/// @param face where the beam leaves the glass, at the table; it enters at -face.
/// @param half half of the deviation in the horizontal plane, rad, off +z.
void add_slit_and_screen(Scene& scene, const Vec3d& face, double half) {
  const Vec3d in(-std::sin(half), 0, std::cos(half)), out(std::sin(half), 0, std::cos(half));
  const Vec3d up(0, 1, 0), beam_height = 0.06 * up;
  scene.lights.push_back({.name = "beam",
                          .kind = SpotLight{.position = beam_height - face - 0.9 * in,
                                            .direction = in,
                                            .intensity = Rgb(60.0F),
                                            .inner_angle = 0,
                                            .outer_angle = 0.045}});
  const auto add_upright = [&](const char* name, const Vec3d& foot, const Vec3d& across, double height, float grey) {
    add_quad(scene, name, {foot - across, foot + across, foot + across + height * up, foot - across + height * up},
             lambertian(name, Rgb(grey)));
  };
  // A plate with a slit 5 mm wide: two halves, the sill below it, the lintel above.
  const Vec3d slit = -face - 0.1 * in, aside(in.z, 0, -in.x);
  constexpr double half_slit = 0.0025, half_plate = 0.06, sill = 0.035, lintel = 0.085, top = 0.12;
  for (const double side : {-1.0, 1.0}) {
    add_upright("plate", slit + side * (half_slit + half_plate) / 2 * aside, (half_plate - half_slit) / 2 * aside, top,
                0.2F);
  }
  add_upright("plate", slit, half_slit * aside, sill, 0.2F);
  add_upright("plate", slit + lintel * up, half_slit * aside, top - lintel, 0.2F);
  add_upright("screen", face + 0.5 * out, -0.2 * Vec3d(out.z, 0, -out.x), 0.16, 0.85F);
  add_quad(scene, "lamp", {Vec3d(-0.3, 1.2, -0.3), Vec3d(0.3, 1.2, -0.3), Vec3d(0.3, 1.2, 0.3), Vec3d(-0.3, 1.2, 0.3)},
           lambertian("lamp", Rgb(0.0F), Rgb(3.0F)));
  scene.cameras = {{.name = "camera",
                    .to_world = look_at({-0.42, 0.34, -0.3}, {0.1, 0.04, 0.2}, {0, 1, 0}),
                    .lens = PerspectiveLens{radians(34)}}};
}

}  // namespace

Scene make_prism(const BuiltinParameters& parameters) {
  Scene scene;
  Material table = lambertian("table", {0.45F, 0.30F, 0.18F});
  table.checker_colour = Rgb(0.38F, 0.24F, 0.14F);
  table.checker_size = 0.08F;
  add_quad(scene, "table", {Vec3d(-1.2, 0, 0.7), Vec3d(1.2, 0, 0.7), Vec3d(1.2, 0, -0.25), Vec3d(-1.2, 0, -0.25)},
           table);

  constexpr double side = 0.16, height = 0.16, apex = 0.065;
  Mesh prism = prism_mesh(side, height, apex);
  prism.materials = {add_material(scene, clear("dense flint", dense_flint))};
  add_object(scene, std::move(prism));

  // The ray of the d line along z inside, deviated least: outside it makes half of that angle with z.
  const double deviation = 2 * std::asin(refractive_index(dense_flint, line_d) * std::sin(radians(30))) - radians(60);
  const double half = deviation / 2;
  const Vec3d face(0, 0, apex * std::tan(radians(30)));  // where it leaves the glass; it enters at -face
  if (parameters["beam"] > 0) {
    add_slit_and_screen(scene, face, half);
    return scene;
  }
  add_strip_lamp(scene, -face, half, 1.1, 0.008, 30);
  const Vec3d eye = face + 0.75 * Vec3d(std::sin(half), 0, std::cos(half)) + Vec3d(0, 0.24, 0);
  scene.environment = Environment{.radiance = Rgb(0.12F), .image = {}};
  scene.cameras = {
      {.name = "camera", .to_world = look_at(eye, {0, 0.08, 0}, {0, 1, 0}), .lens = PerspectiveLens{radians(24)}}};
  return scene;
}

Scene make_rainbow(const BuiltinParameters& parameters) {
  // Drops far smaller than their distances, so that each pixel sees some at every height of their faces.
  const double elevation = radians(parameters["sun"]);
  constexpr double radius = 0.12, spacing = 0.2, distance = 20;
  // Water at 20 degrees (Daimon & Masumura, Applied Optics 46(18), 2007), by Cauchy's formula through its d, F, C
  // lines.
  const Cauchy water{.a = 1.3242, .b = 0.00304, .c = 0};
  Scene scene;
  const std::uint32_t drop = add_material(scene, clear("water", water));
  const Vec3d to_sun(0, std::sin(elevation), std::cos(elevation));  // behind the eye, which looks along -z
  constexpr double bow = 44, top = 56;                              // degrees from the point opposite the sun
  const double half_width = distance * std::tan(radians(bow)) * 1.25;
  const double highest = distance * std::tan(radians(top) - elevation);
  std::uint64_t number = 0;
  for (double y = radius; y < highest; y += spacing) {
    for (double x = -half_width; x <= half_width; x += spacing) {
      CounterRng rng(hash_key(number++));
      const Vec3d jitter(rng.next() - 0.5, rng.next() - 0.5, 4 * rng.next());
      scene.shapes.push_back(
          {.name = "drop", .shape = Sphere{Vec3d(x, y, -distance) + spacing * jitter, radius}, .material = drop});
    }
  }
  constexpr double sun_distance = 1000, sun_radius_degrees = 1;
  scene.shapes.push_back({.name = "sun",
                          .shape = Sphere{sun_distance * to_sun, sun_distance * std::sin(radians(sun_radius_degrees))},
                          .material = add_material(scene, lambertian("sun", Rgb(0.0F), Rgb(6000.0F)))});
  scene.shapes.push_back({.name = "ground",
                          .shape = Plane{{0, -1.6, 0}, {0, 1, 0}},
                          .material = add_material(scene, lambertian("ground", {0.12F, 0.16F, 0.05F}))});
  scene.environment = Environment{.radiance = {0.18F, 0.22F, 0.28F}, .image = {}};
  scene.cameras = {{.name = "camera",
                    .to_world = look_at({0, 0, 0}, {0, std::tan(radians(18)), -1}, {0, 1, 0}),
                    .lens = PerspectiveLens{radians(62)}}};
  return scene;
}

Scene make_fluorescent(const BuiltinParameters&) {
  Scene scene;
  const auto add_ball = [&](const Vec3d& centre, Material material) {
    std::string name = material.name;
    const std::uint32_t number = add_material(scene, std::move(material));
    scene.shapes.push_back({.name = std::move(name), .shape = Sphere{centre, 0.1}, .material = number});
  };
  add_quad(scene, "table", {Vec3d(-1, 0, 0.6), Vec3d(1, 0, 0.6), Vec3d(1, 0, -0.5), Vec3d(-1, 0, -0.5)},
           lambertian("table", Rgb(0.5F)));
  add_quad(scene, "wall", {Vec3d(-1, 0, -0.5), Vec3d(1, 0, -0.5), Vec3d(1, 1, -0.5), Vec3d(-1, 1, -0.5)},
           lambertian("wall", Rgb(0.5F)));

  // Shares of the light of a column's band that leave in a row's.
  const std::vector<double> edges{360, 410, 450, 500, 550, 600, 700};
  Material green = lambertian("green dye", {0.35F, 0.9F, 0.2F});
  green.fluorescence = Fluorescence{edges, {0.05, 0,    0,   0,   0,   0,  //
                                            0,    0.05, 0,   0,   0,   0,  //
                                            0.05, 0.05, 0.3, 0,   0,   0,  //
                                            0.45, 0.5,  0.4, 0.8, 0,   0,  //
                                            0.15, 0.15, 0.1, 0.1, 0.6, 0,  //
                                            0,    0,    0,   0,   0,   0.3}};
  Material orange = lambertian("orange dye", {0.95F, 0.4F, 0.1F});
  orange.fluorescence = Fluorescence{edges, {0.05, 0,    0,    0,    0,   0,  //
                                             0,    0.05, 0,    0,    0,   0,  //
                                             0,    0,    0.05, 0,    0,   0,  //
                                             0,    0,    0,    0.1,  0,   0,  //
                                             0.2,  0.2,  0.25, 0.25, 0.5, 0,  //
                                             0.4,  0.4,  0.4,  0.45, 0.4, 0.9}};
  add_ball({-0.26, 0.1, 0.05}, std::move(green));
  add_ball({0, 0.1, 0}, lambertian("white", Rgb(0.8F)));
  add_ball({0.26, 0.1, 0.05}, std::move(orange));

  Material lamp = lambertian("violet lamp", Rgb(0.0F));
  lamp.emission_spectrum = EmissionSpectrum{{400, 420, 440}, {12, 8}};
  lamp.emission = lamp.emission_spectrum->colour();
  add_quad(scene, "lamp", {Vec3d(-0.4, 0.9, -0.1), Vec3d(0.4, 0.9, -0.1), Vec3d(0.4, 0.9, 0.3), Vec3d(-0.4, 0.9, 0.3)},
           std::move(lamp));
  scene.cameras = {{.name = "camera",
                    .to_world = look_at({0, 0.35, 1.1}, {0, 0.13, 0}, {0, 1, 0}),
                    .lens = PerspectiveLens{radians(38)}}};
  return scene;
}

}  // namespace penumbra
