#include "penumbra/render/ray_waves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

RenderOptions small_picture(IntegratorKind integrator, int samples) {
  RenderOptions options;
  options.integrator = integrator;
  options.width = 75;  // blocks are cut at the edges
  options.height = 50;
  options.samples_per_pixel = samples;
  return options;
}

/// Root mean square of the difference of two pictures' colours, relative to the mean.
double difference(const Image& a, const Image& b) {
  double squares = 0, sum = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const Vec3d d = Vec3d(a.rgb(x, y)) - Vec3d(b.rgb(x, y));
      squares += dot(d, d) / 3;
      sum += luminance(a.rgb(x, y));
    }
  }
  const double pixels = static_cast<double>(a.width) * a.height;
  return std::sqrt(squares / pixels) / (sum / pixels);
}

/// A picture with layers is drawn ray by ray, one without in waves.
void expect_the_scalar_picture(const Scene& scene, const RenderOptions& options, double tolerance) {
  const RayTracer tracer(scene);
  RenderOptions layered = options;
  layered.aovs = {Aov::albedo};
  const RenderResult waves = render(tracer, scene.cameras.at(0), options);
  const RenderResult singly = render(tracer, scene.cameras.at(0), layered);
  EXPECT_LT(difference(waves.image, singly.image), tolerance);
  const auto near = [](std::uint64_t a, std::uint64_t b) {
    return std::abs(static_cast<double>(a) - static_cast<double>(b)) <= 2 + 2e-4 * static_cast<double>(b);
  };
  EXPECT_EQ(waves.rays.primary, singly.rays.primary);
  EXPECT_PRED2(near, waves.rays.shadow, singly.rays.shadow);
  EXPECT_PRED2(near, waves.rays.reflection, singly.rays.reflection);
  EXPECT_PRED2(near, waves.rays.refraction, singly.rays.refraction);
}

// Far out on the checkered floor the square that a ray meets is a matter of rounding: the floor is made plain.
TEST(RayWaves, TheStillLifeIsThePictureOfTheRecursion) {
  Scene scene = make_builtin_scene("whitted");
  for (Material& m : scene.materials) m.checker_colour.reset();
  expect_the_scalar_picture(scene, small_picture(IntegratorKind::whitted, 1), 2e-4);
  expect_the_scalar_picture(scene, small_picture(IntegratorKind::appel, 1), 2e-4);
}

TEST(RayWaves, CheckersNearbyAreTheSame) {
  Scene scene = make_builtin_scene("whitted");
  scene.cameras[0].to_world = look_at(Vec3d(0, 4, -6), Vec3d(0, 0, 0), Vec3d(0, 1, 0));
  expect_the_scalar_picture(scene, small_picture(IntegratorKind::whitted, 1), 5e-3);
}

TEST(RayWaves, MeshesLampsAndGlassAreThoseOfTheRecursion) {
  Scene scene = make_builtin_scene("cornell-box");
  testing::add_shape(scene, Sphere{{0.35, 0.4, 0.3}, 0.15}, testing::glass(1.5F));
  Material polished = testing::matt({0.5F, 0.4F, 0.3F});
  polished.mirror = Rgb(0.4F);
  Mesh mesh = testing::box({0, 0, 0}, {0.2, 0.2, 0.2});
  testing::add_mesh(scene, mesh, polished);
  Mat4d& place = scene.instances.back().to_world;
  place[0] = {0, 0, -1, 0};  // turned, and mirrored
  place[2] = {-1, 0, 0, 0};
  place[3] = {0.7, 0.05, 0.5, 1};
  for (const int samples : {1, 4}) {
    expect_the_scalar_picture(scene, small_picture(IntegratorKind::appel, samples), 2e-3);
  }
  expect_the_scalar_picture(scene, small_picture(IntegratorKind::whitted, 1), 2e-3);
}

// Rough layers over matt bases of two widths, and lamps seen through several panes of clear glass, round and flat.
TEST(RayWaves, GlossAndShadowsThroughGlassAreThoseOfTheRecursion) {
  Scene scene = make_builtin_scene("cornell-box");
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    Material& m = scene.materials[i];
    if (m.emits()) continue;
    m.specular = i % 2 == 0 ? 1.0F : 0.6F;
    m.specular_colour = {1, 0.8F, 0.5F};
    m.roughness = 0.15F + 0.2F * static_cast<float>(i);
  }
  Material tinted = testing::glass(1.4F);
  tinted.base_colour = {0.9F, 0.7F, 0.8F};
  testing::add_shape(scene, Sphere{{0.35, 0.4, 0.3}, 0.1}, tinted);
  testing::add_shape(scene, Sphere{{0.35, 0.25, 0.3}, 0.06}, testing::glass(1.5F));
  testing::add_mesh(scene, testing::box({0, 0, 0}, {0.15, 0.02, 0.15}), tinted);
  scene.instances.back().to_world[3] = {0.1, 0.3, 0.2, 1};
  AmbientLight ambient{Rgb(0.2F)};
  scene.lights.push_back({"ambient", ambient});
  for (const int samples : {1, 4}) {
    expect_the_scalar_picture(scene, small_picture(IntegratorKind::appel, samples), 2e-3);
  }
  expect_the_scalar_picture(scene, small_picture(IntegratorKind::whitted, 1), 2e-3);
}

// Deeper in the tree random numbers are drawn in another order: the same mean, by other samples.
TEST(RayWaves, SoftShadowsInMirrorsHaveTheSameMean) {
  Scene scene = make_builtin_scene("cornell-box");
  for (Material& m : scene.materials) {
    if (!m.emits()) m.mirror = Rgb(0.5F);
  }
  const RayTracer tracer(scene);
  RenderOptions options = small_picture(IntegratorKind::whitted, 16);
  options.width = options.height = 24;
  RenderOptions layered = options;
  layered.aovs = {Aov::albedo};
  const Image waves = render(tracer, scene.cameras.at(0), options).image;
  const Image singly = render(tracer, scene.cameras.at(0), layered).image;
  double a = 0, b = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      a += luminance(waves.rgb(x, y));
      b += luminance(singly.rgb(x, y));
    }
  }
  EXPECT_NEAR(a / b, 1, 5e-3);
}

TEST(RayWaves, ThreadedPicturesAreTheSameBits) {
  const Scene scene = make_builtin_scene("whitted");
  const RayTracer tracer(scene);
  for (const int samples : {1, 20}) {  // one pass, and several
    const RenderOptions options = small_picture(IntegratorKind::whitted, samples);
    const ThreadLimit one(1);
    const Image expected = render(tracer, scene.cameras[0], options).image;
    for (const int threads : {2, 8}) {
      const ThreadLimit limit(threads);
      EXPECT_EQ(render(tracer, scene.cameras[0], options).image.data, expected.data);
    }
  }
}

}  // namespace
}  // namespace penumbra
