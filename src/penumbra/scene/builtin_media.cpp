#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/math/rng.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/builtin_parts.h"

namespace penumbra {

namespace {

constexpr double degree = std::numbers::pi / 180;

void add_to_air(Scene& scene, Medium medium) {
  scene.air.push_back(static_cast<std::uint32_t>(scene.media.size()));
  scene.media.push_back(std::move(medium));
}

Mesh box_mesh(std::string name, std::uint32_t material, const Vec3d& lower, const Vec3d& upper, bool inwards) {
  Mesh mesh;
  mesh.name = std::move(name);
  mesh.materials = {material};
  Mat4d at(1.0);
  at[3] = Vec4d(0.5 * (lower + upper), 1);
  add_box(mesh, at, 0.5 * (upper - lower), inwards);
  return mesh;
}

/// Smooth noise, -1 to 1: random values on the integer lattice with cubic steps between (Perlin 1985's value noise).
double value_noise(const Vec3d& p) {
  const Vec3d cell = glm::floor(p);
  const Vec3d f = p - cell;
  const Vec3d w = f * f * (3.0 - 2.0 * f);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const auto whole = [](double v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)); };
    const std::uint64_t key = hash_key(17U, whole(cell.x + x), whole(cell.y + y), whole(cell.z + z));
    const double value = 2 * CounterRng(key).next() - 1;
    sum += value * (x == 1 ? w.x : 1 - w.x) * (y == 1 ? w.y : 1 - w.y) * (z == 1 ? w.z : 1 - w.z);
  }
  return sum;
}

/// Octaves of noise, each of half the size and strength of the one before.
double turbulence(Vec3d p, int octaves) {
  double sum = 0, strength = 0.5;
  for (int o = 0; o < octaves; ++o, strength *= 0.5, p = 2.03 * p + Vec3d(7.1, 3.7, 5.3))
    sum += strength * value_noise(p);
  return sum;
}

/// How dense a rising column of smoke is, 0 to about 1. @param p m from the middle of its foot; it is 3 m high.
double column_density(const Vec3d& p) {
  const double height = p.y / 3;
  // It widens as it rises, and sways.
  const double radius = 0.16 + 0.34 * height;
  const Vec2d axis(0.22 * std::sin(2.4 * height + 0.4) - 0.09, 0.16 * std::sin(3.1 * height));
  const Vec3d swirl = p + 0.25 * (0.4 + height) * Vec3d(turbulence(1.7 * p, 3), 0, turbulence(1.7 * p + 31.0, 3));
  const double off = std::hypot(swirl.x - axis.x, swirl.z - axis.y) / radius;
  const double core = std::exp(-1.6 * off * off) + 0.75 * turbulence(Vec3d(3.2, 2.2, 3.2) * p, 4) - 0.2;
  const double fade = std::clamp(20 * height, 0.0, 1.0) * std::clamp(4 * (1 - height), 0.0, 1.0);
  return std::clamp(1.8 * core, 0.0, 1.0) * fade * (1 - 0.5 * height) * std::clamp(2 * (2 - off), 0.0, 1.0);
}

DensityGrid smoke_column(std::uint32_t cells) {
  DensityGrid grid;
  grid.box = {{-1.2, 0.1, -1.2}, {1.2, 3.1, 1.2}};
  const auto across = static_cast<std::uint32_t>(std::max(4.0, std::round(0.8 * cells)));
  grid.cells = {across, cells, across};
  grid.values.reserve(std::size_t{across} * cells * across);
  const Vec3d step = grid.box.extent() / Vec3d(grid.cells[0], grid.cells[1], grid.cells[2]);
  for (std::uint32_t x = 0; x < across; ++x) {
    for (std::uint32_t y = 0; y < cells; ++y) {
      for (std::uint32_t z = 0; z < across; ++z) {
        const Vec3d p = grid.box.lower + (Vec3d(x, y, z) + 0.5) * step;
        grid.values.push_back(static_cast<float>(column_density(p - Vec3d(0, grid.box.lower.y, 0))));
      }
    }
  }
  return grid;
}

}  // namespace

Scene make_fog(const BuiltinParameters& parameters) {
  Scene scene;
  const std::uint32_t wall = add_material(scene, lambertian("wall", Rgb(0.35F, 0.33F, 0.3F)));
  const std::uint32_t stone = add_material(scene, lambertian("stone", Rgb(0.55F, 0.5F, 0.42F)));
  const Bounds hall{{-4, 0, -7}, {4, 4, 3}};
  add_object(scene, box_mesh("hall", wall, hall.lower, hall.upper, true));
  // A row of columns before the lamp, and a ball in the gap in the middle.
  int number = 0;
  for (const double x : {-2.3, -1.5, -0.7, 0.7, 1.5, 2.3}) {
    add_object(scene, box_mesh("column " + std::to_string(++number), stone, {x - 0.17, 0, -3.67}, {x + 0.17, 4, -3.33},
                               false));
  }
  scene.shapes.push_back({.name = "ball", .shape = Sphere{{0, 1.5, -3.2}, 0.3}, .material = stone});
  scene.lights.push_back({.name = "spot",
                          .kind = SpotLight{.position = {0.4, 2.9, -6.6},
                                            .direction = normalize(Vec3d(-0.1, -0.28, 1)),
                                            .intensity = Rgb(Vec3d(130, 120, 100)),
                                            .inner_angle = 34 * degree,
                                            .outer_angle = 40 * degree}});
  const double sigma_t = parameters["sigma_t"], albedo = parameters["albedo"];
  add_to_air(scene, {.name = "fog",
                     .absorption = Rgb(static_cast<float>(sigma_t * (1 - albedo))),
                     .scattering = Rgb(static_cast<float>(sigma_t * albedo)),
                     .asymmetry = static_cast<float>(parameters["g"]),
                     .box = hall});
  scene.cameras = {{.name = "camera",
                    .to_world = look_at(Vec3d(-2.6, 1.9, 2.3), Vec3d(0.1, 1.45, -2.6), {0, 1, 0}),
                    .lens = PerspectiveLens{50 * degree}}};
  return scene;
}

Scene make_smoke(const BuiltinParameters& parameters) {
  Scene scene;
  const std::uint32_t ground = add_material(scene, lambertian("ground", Rgb(0.5F, 0.47F, 0.42F)));
  const std::uint32_t iron = add_material(scene, lambertian("iron", Rgb(0.08F)));
  scene.shapes.push_back({.name = "ground", .shape = Plane{{0, 0, 0}, {0, 1, 0}}, .material = ground});
  scene.shapes.push_back({.name = "pot", .shape = Cylinder{{-0.05, 0, 0}, {-0.05, 0.22, 0}, 0.2}, .material = iron});
  scene.lights.push_back({.name = "sun",
                          .kind = DirectionalLight{.direction = normalize(Vec3d(-0.75, -0.8, -0.45)),
                                                   .irradiance = Rgb(Vec3d(3.6, 3.4, 3.0)),
                                                   .angular_radius = 0.265 * degree}});
  scene.environment = Environment{.radiance = {0.32F, 0.42F, 0.6F}, .image = {}};
  const auto density = static_cast<float>(parameters["density"]);
  add_to_air(scene, {.name = "smoke",
                     .absorption = Rgb(0.25F * density),
                     .scattering = Rgb(0.75F * density),
                     .asymmetry = 0.2F,
                     .density = smoke_column(static_cast<std::uint32_t>(parameters["cells"]))});
  scene.cameras = {{.name = "camera",
                    .to_world = look_at(Vec3d(0.3, 1.5, 5.4), Vec3d(-0.15, 1.45, 0), {0, 1, 0}),
                    .lens = PerspectiveLens{40 * degree}}};
  return scene;
}

}  // namespace penumbra
