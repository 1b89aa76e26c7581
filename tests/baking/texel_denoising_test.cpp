#include "penumbra/baking/texel_denoising.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "baking/quad_atlas.h"
#include "penumbra/baking/texel_light.h"
#include "penumbra/math/rng.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

using test::Quad;

/// Charts, a point for each texel.
struct Charts {
  LightmapAtlas atlas;
  Texels texels;
  std::unique_ptr<RayTracer> tracer;
  std::unique_ptr<TexelMap> map;
  std::unique_ptr<AtlasSpace> space;
  std::unique_ptr<SamplePoints> points;
  std::vector<float> light, error;
  std::vector<std::uint8_t> skipped;

  explicit Charts(const std::vector<Quad>& quads) {
    Scene scene;
    scene.materials = {matt(0.5)};
    atlas = test::quad_atlas(std::move(scene), quads);
    texels = make_texels(atlas);
    tracer = std::make_unique<RayTracer>(atlas.scene);
    map = std::make_unique<TexelMap>(atlas, texels);
    space = std::make_unique<AtlasSpace>(*map, *tracer);
    points = std::make_unique<SamplePoints>(*tracer, *map, *space);
    skipped.assign(texels.count(), 0);
  }
  /// Truth and, on top, even noise of this standard deviation, which is also the error told.
  template <class Truth>
  void fill(const Truth& truth, double deviation) {
    CounterRng random(7);
    light.clear();
    for (std::size_t t = 0; t < texels.count(); ++t) {
      const double noise = deviation * std::sqrt(12.0) * (random.next() - 0.5);
      light.insert(light.end(), 3, static_cast<float>(truth(t) + noise));
    }
    error.assign(texels.count(), static_cast<float>(deviation));
  }
  template <class Truth>
  [[nodiscard]] double rms(const Truth& truth) const {
    double squares = 0;
    for (std::size_t t = 0; t < texels.count(); ++t) squares += std::pow(light[3 * t + 1] - truth(t), 2);
    return std::sqrt(squares / static_cast<double>(texels.count()));
  }
  [[nodiscard]] std::uint32_t chart(std::size_t t) const { return atlas.chart_of_triangle[texels.triangles[t]]; }
};

Quad floor_quad(double x0, double x1, int width = 32) {
  return {{Vec3d(x0, 0, 0), {x0, 0, 1}, {x1, 0, 1}, {x1, 0, 0}}, 0, 32, width};
}

TEST(TexelDenoising, ErrorFallsOnAnIrradianceThatIsKnown) {
  Charts floor({floor_quad(0, 1)});
  // Of a small lamp high above the middle.
  const auto truth = [&](std::size_t t) {
    const Vec3d way = floor.texels.positions[t] - Vec3d(0.5, 1.5, 0.5);
    return 5 / std::pow(length_squared(way), 2);
  };
  floor.fill(truth, 0.05);
  const double before = floor.rms(truth);
  denoise_texels(*floor.points, floor.skipped, floor.light, floor.error);
  EXPECT_LT(floor.rms(truth), 0.4 * before);
  double told = 0;
  for (const float e : floor.error) told += e * e;
  EXPECT_LT(std::sqrt(told / static_cast<double>(floor.error.size())), 0.5 * before);
}

TEST(TexelDenoising, WithoutNoiseNothingChanges) {
  Charts floor({floor_quad(0, 1)});
  const auto truth = [&](std::size_t t) { return 1 + floor.texels.positions[t].x; };
  floor.fill(truth, 0);
  const std::vector<float> before = floor.light;
  denoise_texels(*floor.points, floor.skipped, floor.light, floor.error);
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(floor.light[k], before[k], 1e-6);
}

TEST(TexelDenoising, AStepOfLightStays) {
  Charts floor({floor_quad(0, 1)});
  const auto truth = [&](std::size_t t) { return floor.texels.positions[t].x < 0.5 ? 1.0 : 2.0; };
  floor.fill(truth, 0.1);
  const double before = floor.rms(truth);
  denoise_texels(*floor.points, floor.skipped, floor.light, floor.error);
  EXPECT_LT(floor.rms(truth), 0.5 * before);
}

// Light that differs by less than the noise: only what must not be mixed keeps it apart.
TEST(TexelDenoising, ChartsAndWhatAWallPartsAreNotMixed) {
  Charts two({floor_quad(0, 1), floor_quad(1, 2)});
  const auto by_chart = [&](std::size_t t) { return two.chart(t) == 0 ? 1.0 : 1.1; };
  two.fill(by_chart, 0.1);
  denoise_texels(*two.points, two.skipped, two.light, two.error);
  double sums[2] = {}, counts[2] = {};
  for (std::size_t t = 0; t < two.texels.count(); ++t) {
    sums[two.chart(t)] += two.light[3 * t], counts[two.chart(t)] += 1;
  }
  EXPECT_NEAR(sums[1] / counts[1] - sums[0] / counts[0], 0.1, 0.012);

  // A wall along the middle of a floor: beside it, both sides keep their own.
  Charts parted({floor_quad(0, 1), {{Vec3d(0.52, 0, -1), {0.52, 0, 2}, {0.52, 1, 2}, {0.52, 1, -1}}, 0, 8, 8, "wall"}});
  const auto by_side = [&](std::size_t t) { return parted.texels.positions[t].x < 0.52 ? 1.0 : 1.1; };
  parted.fill(by_side, 0.1);
  denoise_texels(*parted.points, parted.skipped, parted.light, parted.error);
  double beside[2] = {}, texels[2] = {};
  for (std::size_t t = 0; t < parted.texels.count(); ++t) {
    const double x = parted.texels.positions[t].x;
    if (parted.chart(t) != 0 || parted.points->is_cut(static_cast<std::uint32_t>(t)) || std::abs(x - 0.52) > 0.1)
      continue;
    beside[x < 0.52 ? 0 : 1] += parted.light[3 * t], texels[x < 0.52 ? 0 : 1] += 1;
  }
  EXPECT_NEAR(beside[1] / texels[1] - beside[0] / texels[0], 0.1, 0.03);
}

TEST(TexelDenoising, ACreaseWithinAChartKeepsItsJump) {
  // A ridge: one chart over two slopes that differ by 60 degrees.
  LightmapAtlas atlas;
  Mesh mesh;
  mesh.materials = {0};
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {0.5, 0.29, 0}, {0.5, 0.29, 1}, {1, 0, 0}, {1, 0, 1}};
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};
  for (const Vec3d& p : mesh.positions) mesh.uv[1].emplace_back(static_cast<float>(p.x), static_cast<float>(p.z));
  atlas.scene.materials = {matt(0.5)};
  atlas.scene.instances.push_back({"ridge", 0, Mat4d(1)});
  atlas.scene.meshes.push_back(mesh);
  atlas.width = atlas.height = 32;
  atlas.charts = {{0, 0, 32, 32, 0}};
  atlas.first_triangle = {0, 4};
  atlas.chart_of_triangle = {0, 0, 0, 0};
  const Texels texels = make_texels(atlas);
  const RayTracer tracer(atlas.scene);
  const TexelMap map(atlas, texels);
  const AtlasSpace space(map, tracer);
  const SamplePoints points(tracer, map, space);
  std::vector<float> light, error(texels.count(), 0.1F);
  CounterRng random(3);
  for (std::size_t t = 0; t < texels.count(); ++t) {
    const double truth = texels.normal(t).x < 0 ? 1.0 : 1.1;
    light.insert(light.end(), 3, static_cast<float>(truth + 0.1 * std::sqrt(12.0) * (random.next() - 0.5)));
  }
  denoise_texels(points, std::vector<std::uint8_t>(texels.count(), 0), light, error);
  double sums[2] = {}, counts[2] = {};
  for (std::size_t t = 0; t < texels.count(); ++t) {
    if (std::abs(texels.positions[t].x - 0.5) > 0.1) continue;
    const int side = texels.normal(t).x < 0 ? 0 : 1;
    sums[side] += light[3 * t], counts[side] += 1;
  }
  EXPECT_NEAR(sums[1] / counts[1] - sums[0] / counts[0], 0.1, 0.03);
}

TEST(TexelDenoising, ABakeOfFewRaysComesCloserToOneOfMany) {
  Scene scene;
  scene.materials = {matt(0.7), matt(0, 3)};
  const std::vector<Quad> quads{
      {{Vec3d(0), {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}, 0, 24, 24, "floor"},
      {{Vec3d(0), {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 0, 24, 24, "wall"},
      {{Vec3d(0.3, 0.99, 0.3), {0.7, 0.99, 0.3}, {0.7, 0.99, 0.7}, {0.3, 0.99, 0.7}}, 1, 8, 8, "lamp"}};
  const LightmapAtlas atlas = test::quad_atlas(scene, quads);
  const Texels texels = make_texels(atlas);
  const TexelLight truth = bake_texel_light(atlas, texels, {.noise = 1e-9, .fewest_rays = 8192, .most_rays = 8192});
  const auto rms = [&](const TexelLight& light) {
    double squares = 0;
    for (std::size_t k = 0; k < light.irradiance.size(); ++k) {
      squares += std::pow(light.irradiance[k] - truth.irradiance[k], 2);
    }
    return std::sqrt(squares);
  };
  TexelLightOptions few{.noise = 0.5, .fewest_rays = 16, .most_rays = 16};
  const double before = rms(bake_texel_light(atlas, texels, few));
  few.denoise = true;
  EXPECT_LT(rms(bake_texel_light(atlas, texels, few)), 0.7 * before);
}

}  // namespace
}  // namespace penumbra
