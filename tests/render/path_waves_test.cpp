#include "penumbra/render/path_waves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/math/sobol.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/path_shading.h"
#include "penumbra/render/sobol_lanes.h"
#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

TEST(SobolLanes, AreTheNumbersOfTheScalarSequence) {
  testing::Dice dice(1);
  for (int round = 0; round < 200; ++round) {
    IndexLanes index;
    KeyLanes key;
    for (std::size_t i = 0; i < index.size(); ++i) {
      index[i] = static_cast<std::uint32_t>(dice.below(1U << 20));
      key[i] = hash_key(dice.below(1000000), i);
    }
    Lanes one, u, v;
    owen_sobol_1d(index, key, one);
    owen_sobol_2d(index, key, u, v);
    for (std::size_t i = 0; i < index.size(); ++i) {
      const Vec2d both = owen_sobol_2d(index[i], key[i]);
      EXPECT_NEAR(one[i], owen_sobol_1d(index[i], key[i]), 0x1p-24);
      EXPECT_NEAR(u[i], both.x, 0x1p-24);
      EXPECT_NEAR(v[i], both.y, 0x1p-24);
      EXPECT_LT(std::max({one[i], u[i], v[i]}), 1.0F);
    }
  }
}

/// Luminance of means over blocks of 6 x 6 pixels.
std::vector<double> blocks_of(const Image& image) {
  constexpr int block = 6;
  std::vector<double> means;
  for (int y = 0; y + block <= image.height; y += block) {
    for (int x = 0; x + block <= image.width; x += block) {
      double sum = 0;
      for (int k = 0; k < block * block; ++k) sum += luminance(image.rgb(x + k % block, y + k / block));
      means.push_back(sum / (block * block));
    }
  }
  return means;
}

/// A picture with layers is drawn path by path, one without in waves. Their differences must be noise.
void expect_the_scalar_picture(const Scene& scene, RenderOptions options) {
  const RayTracer tracer(scene);
  options.width = options.height = 36;
  RenderOptions layered = options;
  layered.aovs = {Aov::albedo};
  const RenderResult waves = render(tracer, scene.cameras.at(0), options);
  layered.seed = options.seed + 1;
  const RenderResult singly = render(tracer, scene.cameras.at(0), layered);
  layered.seed = options.seed + 2;
  const std::vector<double> a = blocks_of(waves.image), b = blocks_of(singly.image),
                            c = blocks_of(render(tracer, scene.cameras.at(0), layered).image);
  double sum_a = 0, sum_b = 0, between = 0, noise = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum_a += a[i];
    sum_b += b[i];
    between += (a[i] - b[i]) * (a[i] - b[i]);
    noise += (b[i] - c[i]) * (b[i] - c[i]);
  }
  EXPECT_NEAR(sum_a / sum_b, 1, 0.01);
  EXPECT_LT(between, 2 * noise);
  const auto near = [](std::uint64_t m, std::uint64_t n) {
    return std::abs(static_cast<double>(m) - static_cast<double>(n)) < 0.01 * static_cast<double>(n);
  };
  EXPECT_EQ(waves.rays.primary, singly.rays.primary);
  EXPECT_PRED2(near, waves.rays.diffuse, singly.rays.diffuse);
}

TEST(PathWaves, TheCornellBoxIsThePictureOfSinglePaths) {
  expect_the_scalar_picture(make_builtin_scene("cornell-box"), testing::path(64));
}

TEST(PathWaves, WavelengthsTravelInWavesToo) {
  RenderOptions options = testing::path(64);
  options.spectral = true;
  expect_the_scalar_picture(make_builtin_scene("cornell-box"), options);
}

TEST(PathWaves, SpheresPlanesAndLampsOfTwoBrightnessesToo) {
  Scene scene = make_builtin_scene("cornell-box");
  testing::add_shape(scene, Sphere{{0.3, 0.35, 0.3}, 0.1}, testing::matt({0.2F, 0.7F, 0.4F}));
  testing::add_plane(scene, {0, -0.5, 0}, {0, 1, 0}, testing::matt(Rgb(0.5F)));
  Material lamp = testing::glow({4, 3, 9});
  lamp.double_sided = true;
  testing::add_mesh(scene, testing::rectangle({0.1, 0.2, 0.2}, {0.15, 0, 0}, {0, 0.2, 0.05}), lamp);
  expect_the_scalar_picture(scene, testing::path(64));
}

TEST(PathWaves, ThreadedPicturesAreTheSameBits) {
  const Scene scene = make_builtin_scene("cornell-box");
  const RayTracer tracer(scene);
  RenderOptions options = testing::path(6);
  options.width = 70;
  options.height = 45;
  for (const bool spectral : {false, true}) {
    options.spectral = spectral;
    std::vector<std::vector<float>> pictures;
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      pictures.push_back(render(tracer, scene.cameras[0], options).image.data);
    }
    EXPECT_EQ(pictures[0], pictures[1]);
    EXPECT_EQ(pictures[0], pictures[2]);
  }
}

}  // namespace
}  // namespace penumbra
