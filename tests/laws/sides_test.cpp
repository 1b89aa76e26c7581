// One rule for sides: surfaces reflect on both, so that faces turned the wrong way round change nothing, whichever
// method finds the light.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "baking/quad_atlas.h"
#include "penumbra/baking/texel_light.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/render/solution_light.h"
#include "penumbra/render/two_pass.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using test::Quad;

constexpr float room_reflectance = 0.7F, floor_reflectance = 0.5F;
constexpr int pixels = 32, blocks = 4;

/// A room of 2 x 2 x 2 m, a lamp below its ceiling, a block on its floor. The floor is the first.
std::vector<Quad> room(bool flipped) {
  const auto p = [](double x, double y, double z) { return Vec3d(x, y, z); };
  std::vector<Quad> quads{
      {{p(0, 0, 0), p(0, 0, 2), p(2, 0, 2), p(2, 0, 0)}, 0, 64, 64, "floor"},
      {{p(0, 2, 0), p(2, 2, 0), p(2, 2, 2), p(0, 2, 2)}, 1, 24, 24, "ceiling"},
      {{p(0, 0, 2), p(0, 0, 0), p(0, 2, 0), p(0, 2, 2)}, 1, 24, 24, "left"},
      {{p(2, 0, 0), p(2, 0, 2), p(2, 2, 2), p(2, 2, 0)}, 1, 24, 24, "right"},
      {{p(0, 0, 0), p(2, 0, 0), p(2, 2, 0), p(0, 2, 0)}, 1, 24, 24, "back"},
      {{p(2, 0, 2), p(0, 0, 2), p(0, 2, 2), p(2, 2, 2)}, 1, 24, 24, "front"},
      {{p(0.3, 0, 0.3), p(0.9, 0, 0.3), p(0.9, 0.7, 0.3), p(0.3, 0.7, 0.3)}, 1, 16, 16, "block"},
      {{p(0.9, 0, 0.9), p(0.3, 0, 0.9), p(0.3, 0.7, 0.9), p(0.9, 0.7, 0.9)}, 1, 16, 16, "block"},
      {{p(0.3, 0, 0.9), p(0.3, 0, 0.3), p(0.3, 0.7, 0.3), p(0.3, 0.7, 0.9)}, 1, 16, 16, "block"},
      {{p(0.9, 0, 0.3), p(0.9, 0, 0.9), p(0.9, 0.7, 0.9), p(0.9, 0.7, 0.3)}, 1, 16, 16, "block"},
      {{p(0.3, 0.7, 0.3), p(0.3, 0.7, 0.9), p(0.9, 0.7, 0.9), p(0.9, 0.7, 0.3)}, 1, 16, 16, "block"},
      {{p(0.8, 1.98, 0.8), p(1.4, 1.98, 0.8), p(1.4, 1.98, 1.4), p(0.8, 1.98, 1.4)}, 2, 8, 8, "lamp"}};
  // The block's sides above are wound inwards: turn them out, then half of everything but floor and lamp the wrong way.
  for (std::size_t k = 6; k < 10; ++k) std::swap(quads[k].corners[1], quads[k].corners[3]);
  for (const std::size_t k : {1, 3, 4, 7, 8, 10}) {
    if (flipped) std::swap(quads[k].corners[1], quads[k].corners[3]);
  }
  return quads;
}

Scene materials() {
  Scene scene;
  scene.materials = {matt(floor_reflectance), matt(room_reflectance), matt(0, 10)};
  return scene;
}

/// Straight down on 1.6 x 1.6 m of the floor and what stands there, from below the lamp.
Camera above() {
  return {.name = "above", .to_world = look_at({1, 1.9, 1}, {1, 0, 1}, {0, 0, -1}), .lens = OrthographicLens{1.6}};
}

RenderOptions options(int samples) {
  RenderOptions o;
  o.width = o.height = pixels;
  o.samples_per_pixel = samples;
  return o;
}

/// Irradiance of the floor, green, means of blocks of pixels row by row; those that show the block are left out (0).
using Floor = std::array<double, std::size_t{blocks} * blocks>;

Floor floor_of(const auto& irradiance) {
  Floor sums{};
  constexpr int side = pixels / blocks;
  for (int y = 0; y < pixels; ++y) {
    for (int x = 0; x < pixels; ++x) {
      sums[static_cast<std::size_t>(y / side * blocks + x / side)] += irradiance(x, y) / (side * side);
    }
  }
  for (const std::size_t k : {0U, 1U, 4U, 5U}) sums[k] = 0;
  return sums;
}

Floor of_picture(const Image& image) {
  return floor_of([&](int x, int y) { return pi * static_cast<double>(image.rgb(x, y).y / floor_reflectance); });
}

Floor by_paths(const Scene& scene) {
  RenderOptions path = options(2048);
  path.integrator = IntegratorKind::path;
  return of_picture(render(RayTracer(scene), above(), path).image);
}

Floor by_two_passes(const Scene& scene) {
  RadiositySetupOptions setup_options;
  setup_options.element_count = 3000;
  setup_options.factors.tolerance = 1e-3;
  const auto setup = make_radiosity_setup(scene, setup_options);
  const SceneRadiosity solved = solve(*setup, {});
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::both, 8);
  const LampIrradiance lamps(scene, faces.mesh);
  const RayTracer tracer(scene);
  const SolutionLight light(tracer, setup->mesh, solved.solution.irradiance, solved.caustics, lamps);
  return of_picture(render(tracer, light, above(), options(16)).image);
}

Floor by_texels(const LightmapAtlas& atlas) {
  const Texels texels = make_texels(atlas);
  const TexelLight light = bake_texel_light(atlas, texels, {.noise = 0.005});
  // Texels of the floor by their place, and the mean over those under each pixel: 64 texels for 2 m, 32 pixels for 1.6.
  constexpr int across = 64;
  std::vector<double> at(std::size_t{across} * across, 0);
  for (std::size_t t = 0; t < texels.count(); ++t) {
    if (atlas.chart_of_triangle[texels.triangles[t]] != 0) continue;
    const Vec3d& p = texels.positions[t];
    const auto column = static_cast<std::size_t>(p.x / 2 * across), row = static_cast<std::size_t>(p.z / 2 * across);
    at[row * across + column] = light.irradiance[3 * t + 1];
  }
  return floor_of([&](int x, int y) {
    double sum = 0;
    constexpr int fine = 8;
    for (int k = 0; k < fine * fine; ++k) {
      const double px = 0.2 + 1.6 * (x + (k % fine + 0.5) / fine) / pixels;
      const double pz = 0.2 + 1.6 * (y + (k / fine + 0.5) / fine) / pixels;
      sum += at[static_cast<std::size_t>(pz / 2 * across) * across + static_cast<std::size_t>(px / 2 * across)];
    }
    return sum / (fine * fine);
  });
}

double mean(const Floor& floor) {
  double sum = 0, count = 0;
  for (const double v : floor) sum += v, count += v > 0 ? 1 : 0;
  return sum / count;
}

TEST(Sides, SlowPathsTwoPassesAndTexelsAgreeHoweverFacesAreTurned) {
  const Floor reference = by_paths(test::quad_atlas(materials(), room(false)).scene);
  for (const bool flipped : {false, true}) {
    const LightmapAtlas atlas = test::quad_atlas(materials(), room(flipped));
    const std::array<std::pair<std::string, Floor>, 3> found{
        {{"path", by_paths(atlas.scene)}, {"two-pass", by_two_passes(atlas.scene)}, {"bake", by_texels(atlas)}}};
    for (const auto& [method, floor] : found) {
      EXPECT_NEAR(mean(floor) / mean(reference), 1, 0.01) << method << (flipped ? ", flipped" : "");
      for (std::size_t k = 0; k < floor.size(); ++k) {
        if (reference[k] == 0) continue;
        EXPECT_NEAR(floor[k] / reference[k], 1, 0.02) << method << (flipped ? ", flipped, block " : ", block ") << k;
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
