// Scenes that try to break arithmetic: slivers, faces without area, specks, meshes turned inside out, tiny and huge
// rooms, rooms far from the origin, thousands of lights, hardly any absorption, glass in glass. Whatever stands in a
// closed room where everything emits L and reflects rho alike, radiance is L / (1 - rho) everywhere, so that most of
// them have a known answer; the rest keeps its energy.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "penumbra/image/image.h"
#include "penumbra/math/transform.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/render/render.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

constexpr double pi = std::numbers::pi;

struct Placement {
  double scale = 1, offset = 0;
};
constexpr Placement placements[] = {{1, 0}, {1e-6, 0}, {1e6, 0}, {1, 1e5}, {1e-3, 10}};

std::string say(const Placement& p) { return fmt::format("scale {}, offset {}", p.scale, p.offset); }

Polygon placed(Polygon polygon, const Placement& at) {
  for (Vec3d& p : polygon) p = at.scale * p + Vec3d(at.offset);
  return polygon;
}

Vec3d point_inside(Dice& dice) { return {dice.between(0.1, 0.9), dice.between(0.1, 0.9), dice.between(0.1, 0.9)}; }

/// Thin triangles, from a hundredth to a hundred millionth as wide as long; one in ten has no width at all.
std::vector<Polygon> slivers(Dice& dice, int count) {
  std::vector<Polygon> all;
  for (int k = 0; k < count; ++k) {
    const Vec3d a = point_inside(dice), b = point_inside(dice), aside = point_inside(dice) - Vec3d(0.5);
    const double width = k % 10 == 0 ? 0 : std::pow(10, -dice.between(2, 8));
    all.push_back({a, b, a + dice.between(0, 1) * (b - a) + width * aside});
  }
  return all;
}

/// Triangles whose corners coincide, and specks of a size as a share of the room's.
std::vector<Polygon> specks(Dice& dice, int count, double size) {
  std::vector<Polygon> all;
  for (int k = 0; k < count; ++k) {
    const Vec3d a = point_inside(dice);
    all.push_back({a, a, k % 2 == 0 ? a : point_inside(dice)});
    all.push_back({a, a + Vec3d(size, 0, 0), a + Vec3d(0, size, size)});
  }
  return all;
}

/// Boxes that may cross each other, every second turned inside out.
std::vector<Polygon> boxes(Dice& dice, int count) {
  std::vector<Polygon> all;
  for (int k = 0; k < count; ++k) {
    const Vec3d corner = 0.6 * point_inside(dice) + Vec3d(0.05);
    for (const Polygon& face : room({0.05 + 0.2 * dice.between(0, 1), 0.2, 0.1})) {
      all.push_back(moved(k % 2 == 0 ? Polygon(face.rbegin(), face.rend()) : face, corner));
    }
  }
  return all;
}

/// A closed room where all sides emit `radiance` and reflect `rho`, with clutter.
Scene furnace(const std::vector<Polygon>& clutter, double rho, double radiance, const Placement& at) {
  std::vector<Polygon> faces;
  for (const Polygon& p : room({1, 1, 1})) faces.push_back(placed(p, at));
  for (const Polygon& p : clutter) faces.push_back(placed(p, at));
  Scene scene = polygon_scene(faces);
  scene.materials[0] = matt(rho, radiance);
  scene.materials[0].double_sided = true;
  return scene;
}

Camera eye_in(const Placement& at) {
  Camera camera;
  camera.to_world = look_at(at.scale * Vec3d(0.04, 0.05, 0.06) + Vec3d(at.offset),
                            at.scale * Vec3d(0.6, 0.5, 0.55) + Vec3d(at.offset), {0, 1, 0});
  camera.lens = PerspectiveLens{1.2};
  return camera;
}

/// A small picture; every value must be finite and not negative.
Image picture(const Scene& scene, const Placement& at, IntegratorKind integrator, int samples, int depth = 0) {
  const RayTracer tracer(scene);
  RenderOptions options;
  options.integrator = integrator;
  options.width = options.height = 12;
  options.samples_per_pixel = samples;
  options.max_depth = depth;
  Image image = render(tracer, eye_in(at), options).image;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = image.pixel(x, y)[c];
        EXPECT_TRUE(std::isfinite(value) && value >= 0) << value << " at " << x << ", " << y;
      }
    }
  }
  return image;
}

double mean_of(const Image& image) {
  double sum = 0;
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x) sum += static_cast<double>(image.pixel(x, y)[0]);
  return sum / 144;
}

struct Solved {
  std::unique_ptr<RadiositySetup> setup;
  SceneRadiosity result;
};

/// Solves it, and checks what holds for any scene: values finite and not negative, the energy kept.
Solved solved(const Scene& scene, std::size_t elements, const std::string& solver = "gauss-seidel",
              Subdivision subdivision = Subdivision::uniform) {
  RadiositySetupOptions options;
  options.element_count = elements;
  options.solver = solver;
  options.subdivision = subdivision;
  options.factors.tolerance = 1e-3;
  Solved s{make_radiosity_setup(scene, options), {}};
  s.result = solve(*s.setup, {});
  const RadiositySolution& solution = s.result.solution;
  EXPECT_TRUE(solution.converged);
  for (const auto* values : {&solution.radiosity, &solution.irradiance}) {
    for (const double v : *values) EXPECT_TRUE(std::isfinite(v) && v >= 0) << v;
  }
  const EnergyBalance& e = solution.energy;
  EXPECT_NEAR(e.absorbed + e.escaped + e.unshot, e.emitted, 1e-6 * e.emitted);
  return s;
}

/// In a closed room each side of an element that is inside sees something everywhere: rows sum to 1.
void expect_closed_rows(const Solved& s, double tolerance) {
  for (std::size_t i = 0; i < s.setup->factors.rows(); ++i) {
    const double sum = s.setup->factors.row_sum(i);
    if (s.setup->mesh.surfaces[i].face < 6 && s.setup->mesh.surfaces[i].back) {
      EXPECT_EQ(sum, 0) << "the outside sees nothing";
    } else {
      EXPECT_NEAR(sum, 1, tolerance) << s.setup->mesh.surfaces[i].name << " " << s.setup->mesh.surfaces[i].area;
    }
  }
}

void expect_furnace(const std::function<std::vector<Polygon>(const Placement&)>& clutter, double row_tolerance) {
  constexpr double rho = 0.5, radiance = 1, truth = radiance / (1 - rho);
  for (const Placement& at : placements) {
    SCOPED_TRACE(say(at));
    const Scene scene = furnace(clutter(at), rho, radiance, at);
    const Solved s = solved(scene, 150);
    expect_closed_rows(s, row_tolerance);
    for (std::size_t i = 0; i < s.setup->mesh.surface_count(); ++i) {
      if (s.setup->factors.row_sum(i) == 0) continue;
      EXPECT_NEAR(s.result.solution.radiosity[3 * i], pi * truth, 2 * row_tolerance * pi * truth);
    }
    EXPECT_NEAR(mean_of(picture(scene, at, IntegratorKind::path, 16)), truth, 0.02 * truth);
    // Its light straight from what shines, which is all around.
    EXPECT_NEAR(mean_of(picture(scene, at, IntegratorKind::whitted, 64)), (1 + rho) * radiance, 0.1 * radiance);
  }
}

TEST(HostileScenes, SliversInAFurnaceAreUnseen) {
  expect_furnace(
      [](const Placement&) {
        Dice dice(1);
        return slivers(dice, 8);
      },
      2e-3);
}

TEST(HostileScenes, SpecksAndFacesWithoutAreaInAFurnaceAreUnseen) {
  expect_furnace(
      [](const Placement& at) {
        Dice dice(2);
        return specks(dice, 10, at.offset == 0 ? 1e-6 : 1e-4);  // what is far away is rounded
      },
      2e-3);
}

TEST(HostileScenes, BoxesTurnedInsideOutInAFurnaceAreUnseen) {
  expect_furnace(
      [](const Placement&) {
        Dice dice(3);
        return boxes(dice, 2);
      },
      2e-3);
}

TEST(HostileScenes, HardlyAnythingIsAbsorbed) {
  constexpr double rho = 0.999;
  const Scene scene = furnace({}, rho, 1, {});
  const Solved s = solved(scene, 150);
  // A row's error counts 1 / (1 - rho) times.
  for (std::size_t i = 0; i < s.setup->mesh.surface_count(); ++i) {
    if (s.setup->mesh.surfaces[i].back) continue;
    EXPECT_NEAR(s.result.solution.radiosity[3 * i], 1000 * pi, 20 * pi);
  }
  (void)picture(scene, {}, IntegratorKind::path, 1, 100);
  (void)picture(scene, {}, IntegratorKind::whitted, 1);
}

// Faces that lie on one another in part cannot all be seen; whatever the factors make of it, light must not grow
// without end.
TEST(HostileScenes, CoplanarOverlapsStayBounded) {
  for (const double rho : {0.5, 0.999}) {
    SCOPED_TRACE(rho);
    Dice dice(4);
    std::vector<Polygon> clutter;
    for (int k = 0; k < 6; ++k) {
      const double x = dice.between(0, 0.5), y = dice.between(0, 0.5);
      clutter.push_back(floor_rectangle(x, x + dice.between(0.1, 0.5), y, y + dice.between(0.1, 0.5)));
    }
    const Scene scene = furnace(clutter, rho, 1, {});
    const Solved s = solved(scene, 300);
    for (const double b : s.result.solution.radiosity) EXPECT_LE(b, 1.1 * pi / (1 - rho));
    (void)picture(scene, {}, IntegratorKind::path, 4, 50);
    (void)picture(scene, {}, IntegratorKind::whitted, 2);
  }
}

TEST(HostileScenes, TenThousandLightsBringTheirFlux) {
  Scene scene = polygon_scene(room({1, 1, 1}));
  scene.materials[0] = matt(0.5);
  Dice dice(5);
  constexpr int count = 10'000;
  for (int k = 0; k < count; ++k) scene.lights.push_back({"lamp", PointLight{point_inside(dice), Rgb(1.0F / count)}});
  const Solved s = solved(scene, 12);
  EXPECT_NEAR(s.result.solution.energy.emitted, 3 * 4 * pi, 1e-3);
  EXPECT_NEAR(s.result.solution.energy.absorbed, 3 * 4 * pi, 5e-3 * 3 * 4 * pi);
  const double whitted = mean_of(picture(scene, {}, IntegratorKind::whitted, 1));
  EXPECT_GT(mean_of(picture(scene, {}, IntegratorKind::path, 8)), whitted);  // which has no light that walls reflect
}

// Clear glass takes no light away: where all shines alike it is not seen, however much of it is nested.
TEST(HostileScenes, NestedGlassInAFurnaceIsUnseen) {
  Scene scene = furnace({}, 0, 1, {});
  Material glass = matt(1);
  glass.transmission = 1;
  glass.specular = 1;
  glass.roughness = 0;
  for (int k = 0; k < 6; ++k) {
    glass.ior = 1.1F + 0.2F * static_cast<float>(k);
    scene.materials.push_back(glass);
    scene.shapes.push_back({"glass", Sphere{Vec3d(0.5), 0.4 - 0.05 * k}, static_cast<std::uint32_t>(k + 1)});
  }
  EXPECT_NEAR(mean_of(picture(scene, {}, IntegratorKind::path, 32)), 1, 0.02);
  const double whitted = mean_of(picture(scene, {}, IntegratorKind::whitted, 1));
  EXPECT_LE(whitted, 1 + 1e-4);
  EXPECT_GE(whitted, 0.9);  // rays end at a depth
}

// A room whose lamps shine outwards is dark inside, and turning a mesh that reflects changes nothing.
TEST(HostileScenes, MeshesTurnedInsideOut) {
  const std::vector<Polygon> faces = room({1, 1, 1});
  Scene outwards = polygon_scene(reversed(faces));
  outwards.materials[0] = matt(0.5, 1);
  const Solved dark = solved(outwards, 200);
  for (std::size_t i = 0; i < dark.setup->mesh.surface_count(); ++i) {
    if (dark.setup->mesh.surfaces[i].back) {
      EXPECT_EQ(dark.result.solution.radiosity[3 * i], 0);
    }
  }
  EXPECT_EQ(dark.result.leak, 0);
  EXPECT_EQ(mean_of(picture(outwards, {}, IntegratorKind::path, 4)), 0);
  EXPECT_EQ(mean_of(picture(outwards, {}, IntegratorKind::whitted, 1)), 0);

  double absorbed[2] = {};
  for (const bool turned : {false, true}) {
    std::vector<Polygon> walls(faces.begin() + 1, faces.end());
    Scene scene = polygon_scene(turned ? reversed(walls) : walls);
    scene.materials[0] = matt(0.5);
    scene.materials.push_back(matt(0.2, 1));
    add_polygons(scene, "lamp", {faces[0]}, 1);
    absorbed[turned ? 1 : 0] = solved(scene, 200).result.solution.energy.absorbed;
  }
  EXPECT_NEAR(absorbed[0], absorbed[1], 1e-9 * absorbed[0]);
}

// Refined as light arrives, or cut along shadow lines: the same clutter, the same laws.
TEST(HostileScenes, AdaptiveElementsAmongSliversKeepTheEnergy) {
  Dice dice(6);
  for (const Placement& at : {Placement{1, 0}, Placement{1e-6, 0}, Placement{1, 1e5}}) {
    SCOPED_TRACE(say(at));
    std::vector<Polygon> faces;
    for (const Polygon& p : room({1, 1, 1})) faces.push_back(placed(p, at));
    for (const Polygon& p : slivers(dice, 4)) faces.push_back(placed(p, at));
    Scene scene = polygon_scene(faces);
    scene.materials[0] = matt(0.5);
    scene.materials.push_back(matt(0, 1));
    add_polygons(scene, "lamp", {placed(reversed(floor_rectangle(0.4, 0.6, 0.4, 0.6, 0.95)), at)}, 1);
    (void)solved(scene, 200, "shooting", Subdivision::adaptive);
    (void)solved(scene, 200, "gauss-seidel", Subdivision::adaptive);
  }
}

}  // namespace
}  // namespace penumbra
