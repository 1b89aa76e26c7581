// What arrives from every kind of light, against closed forms; densities against what they describe.

#include "penumbra/tracing/shading/light_sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "penumbra/tracing/ray_tracer.h"
#include "tracing/soup.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using testing::Dice;
using testing::random_soup;
using testing::rectangle;

/// The receiver: at the origin, facing up.
SurfacePoint receiver(const Vec3d& position = Vec3d(0)) {
  SurfacePoint p;
  p.position = position;
  p.geometric_normal = p.shading_normal = {0, 1, 0};
  return p;
}

/// A dark matt material 0 and a lamp material 1 of radiance 3.
Scene scene_with_lamp() {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].emission = Rgb(3);
  return scene;
}

void add_mesh_lamp(Scene& scene, Mesh mesh, const Mat4d& to_world = Mat4d(1.0)) {
  mesh.materials = {1};
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({"lamp", static_cast<std::uint32_t>(scene.meshes.size() - 1), to_world});
}

struct Estimate {
  double mean = 0;
  double error = 0;  ///< standard error of the mean
};

template <class Draw>
Estimate monte_carlo(int n, Draw&& draw) {
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double x = draw();
    sum += x;
    squares += x * x;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

/// Irradiance (green) on the receiver, W/m^2, nothing in between, by choosing lights and points on them.
Estimate irradiance(const Scene& scene, const SurfacePoint& at, int n = 20000, const Vec3d& facing = Vec3d(0)) {
  const LightSampler lights(scene);
  Dice dice(1);
  return monte_carlo(n, [&] {
    const double u = dice.unit();
    const auto s = lights.sample(at, u, dice.square(), facing);
    return s ? std::max(0.0, dot(s->direction, at.shading_normal)) * s->weight().y : 0.0;
  });
}

void expect_irradiance(const Scene& scene, double truth, const SurfacePoint& at = receiver()) {
  for (const Vec3d& facing : {Vec3d(0), at.shading_normal}) {
    const Estimate e = irradiance(scene, at, 20000, facing);
    EXPECT_NEAR(e.mean, truth, 4 * e.error + 2e-6 * truth);
    EXPECT_LE(e.error, 0.05 * truth) << "too noisy to tell";
  }
}

/// Lambert 1760: projected solid angle over pi times pi of a polygon wholly above the horizon of a receiver that faces
/// +y; corners counter-clockwise seen from the receiver.
double lambert_sum(const Vec3d& from, std::vector<Vec3d> corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = normalize(corners[i] - from);
    const Vec3d b = normalize(corners[(i + 1) % corners.size()] - from);
    sum += std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * normalize(cross(a, b)).y;
  }
  return std::abs(0.5 * sum);
}

TEST(LightSampler, PointLightsFallWithTheSquareOfDistance) {
  Scene scene = scene_with_lamp();
  PointLight light;
  light.position = {3, 4, 0};
  light.intensity = Rgb(50);
  scene.lights.push_back({"", light});
  expect_irradiance(scene, 50 / 25.0 * 0.8);
  light.range = 5;  // exactly at the window's end
  scene.lights[0].kind = light;
  EXPECT_EQ(irradiance(scene, receiver(), 10).mean, 0);
  light.range = 10;
  scene.lights[0].kind = light;
  expect_irradiance(scene, 50 / 25.0 * 0.8 * (1 - 1 / 16.0));
  light.inverse_square = false;
  scene.lights[0].kind = light;
  expect_irradiance(scene, pi * 50 * 0.8);
}

TEST(LightSampler, SpotLightsShineInTheirCone) {
  SpotLight spot;
  spot.position = {0, 2, 0};
  spot.direction = {0, -1, 0};
  spot.intensity = Rgb(8);
  spot.inner_angle = 0.3;
  spot.outer_angle = 0.6;
  Scene scene = scene_with_lamp();
  scene.lights.push_back({"", spot});
  expect_irradiance(scene, 2);
  for (const double angle : {0.29, 0.45, 0.59, 0.61}) {
    const SurfacePoint at = receiver({2 * std::tan(angle), 0, 0});
    const double a = std::clamp((std::cos(angle) - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6)), 0.0, 1.0);
    const double truth = 8 * a * a * std::pow(std::cos(angle), 3) / 4;
    EXPECT_NEAR(irradiance(scene, at, 10).mean, truth, 1e-5) << angle;
  }
}

TEST(LightSampler, DirectionalLightsAreTheSameEverywhere) {
  Scene scene = scene_with_lamp();
  scene.lights.push_back({"", DirectionalLight{normalize(Vec3d(3, -4, 0)), Rgb(10)}});
  expect_irradiance(scene, 8);
  expect_irradiance(scene, 8, receiver({100, -3, 7}));
}

TEST(LightSampler, ADiskOnItsAxis) {
  Scene scene = scene_with_lamp();
  scene.shapes.push_back({"", Disk{{0, 2, 0}, {0, -1, 0}, 1.5}, 1});
  expect_irradiance(scene, pi * 3 * 1.5 * 1.5 / (1.5 * 1.5 + 4));  // pi L sin^2
  std::get<Disk>(scene.shapes[0].shape).normal = {0, 1, 0};
  EXPECT_EQ(irradiance(scene, receiver(), 100).mean, 0) << "it shows its back";
  scene.materials[1].double_sided = true;
  expect_irradiance(scene, pi * 3 * 1.5 * 1.5 / (1.5 * 1.5 + 4));
}

TEST(LightSampler, ASphereLikeAPointOfItsPower) {
  Scene scene = scene_with_lamp();
  scene.shapes.push_back({"", Sphere{{0, 3, 4}, 2}, 1});
  expect_irradiance(scene, pi * 3 * (4 / 25.0) * 0.6);
  std::get<Sphere>(scene.shapes[0].shape) = Sphere{{0, 1, 0}, 1e-3};
  expect_irradiance(scene, pi * 3 * 1e-6);
  std::get<Sphere>(scene.shapes[0].shape) = Sphere{{0, 0.5, 0}, 2};  // the receiver inside
  EXPECT_EQ(irradiance(scene, receiver(), 100).mean, 0) << "backs do not shine";
  scene.materials[1].double_sided = true;
  expect_irradiance(scene, pi * 3);
}

// A cylinder around the receiver, open above: sin^2 of the horizon less the hole's.
TEST(LightSampler, ACylinderSeenFromWithin) {
  Scene scene = scene_with_lamp();
  scene.materials[1].double_sided = true;
  scene.shapes.push_back({"", Cylinder{{0, 0, 0}, {0, 2, 0}, 1}, 1});
  expect_irradiance(scene, pi * 3 * (1 - 1 / 5.0));
}

TEST(LightSampler, PolygonsByLambertsSum) {
  Dice dice(2);
  for (int n = 0; n < 10; ++n) {
    const Vec3d corner(dice.between(-2, 1), dice.between(1, 3), dice.between(-2, 1));
    const Vec3d e1(dice.between(0.5, 2), dice.between(-0.3, 0.3), 0);
    const Vec3d e2(0, dice.between(-0.3, 0.3), dice.between(0.5, 2));
    Scene scene = scene_with_lamp();
    const Mesh mesh = rectangle(corner, e1, e2);  // e1 x e2 points down
    add_mesh_lamp(scene, mesh);
    expect_irradiance(scene, 3 * lambert_sum(Vec3d(0), mesh.positions));
    // The same lamp, placed by a transform that mirrors it, and its corners turned to keep the front below.
    Mat4d mirror(1.0);
    mirror[0].x = -1;
    Scene mirrored = scene_with_lamp();
    Mesh flipped = mesh;
    for (Vec3d& p : flipped.positions) p.x = -p.x;
    for (auto& [a, b, c] : flipped.triangles) std::swap(b, c);
    add_mesh_lamp(mirrored, flipped, mirror);
    expect_irradiance(mirrored, 3 * lambert_sum(Vec3d(0), mesh.positions));
  }
}

TEST(LightSampler, OneSidedPolygonsKeepTheirBacksDark) {
  Scene scene = scene_with_lamp();
  add_mesh_lamp(scene, rectangle({-1, 2, -1}, {0, 0, 2}, {2, 0, 0}));  // faces up
  EXPECT_EQ(irradiance(scene, receiver(), 1000).mean, 0);
  EXPECT_FALSE(emits_towards(scene.materials[1], {0, 1, 0}, {0, -1, 0}));
  EXPECT_TRUE(emits_towards(scene.materials[1], {0, 1, 0}, {0, 1, 0}));
  scene.materials[1].double_sided = true;
  expect_irradiance(scene, 3 * lambert_sum(Vec3d(0), scene.meshes[0].positions));
}

TEST(LightSampler, LampsOfManyMaterialsCountEachOnItsOwn) {
  Scene scene = scene_with_lamp();
  scene.materials.push_back(scene.materials[1]);
  scene.materials[2].emission = Rgb(20);
  Mesh mesh = rectangle({-1, 2, -1}, {2, 0, 0}, {0, 0, 2});
  mesh.materials = {1, 2};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"", 0, Mat4d(1.0)});
  const auto& p = mesh.positions;
  expect_irradiance(scene,
                    3 * lambert_sum(Vec3d(0), {p[0], p[1], p[2]}) + 20 * lambert_sum(Vec3d(0), {p[0], p[2], p[3]}));
}

TEST(LightSampler, AnEmissionTextureIsReadWhereTheLightStarts) {
  Scene scene = scene_with_lamp();
  scene.images.push_back({"", 2, 1, 3, std::vector<std::uint8_t>{255, 255, 255, 0, 0, 0}});
  Texture nearest;
  nearest.filter = TexelFilter::nearest;
  scene.textures.push_back(nearest);
  scene.materials[1].emission_texture = TextureRef{};
  add_mesh_lamp(scene, rectangle({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}));
  expect_irradiance(scene, 3 * lambert_sum(Vec3d(0), {{-1, 2, -1}, {0, 2, -1}, {0, 2, 1}, {-1, 2, 1}}));
  // Round a sphere too: its u = 0 .. 1/2 is the half with z < 0.
  Scene ball = scene;
  ball.meshes.clear();
  ball.instances.clear();
  ball.shapes.push_back({"", Sphere{{0, 3, 0}, 1}, 1});
  const LightSampler lights(ball);
  Dice dice(3);
  for (int i = 0; i < 200; ++i) {
    const auto s = lights.sample_light(0, receiver(), dice.square());
    ASSERT_TRUE(s);
    if (std::abs(s->direction.z) < 1e-3) continue;
    EXPECT_EQ(is_black(s->radiance), s->direction.z > 0);
  }
}

TEST(LightSampler, HolesInLampsAreDarkAndBlendedLampsShineInPart) {
  Scene scene = scene_with_lamp();
  Mesh mesh = rectangle({-1, 2, -1}, {2, 0, 0}, {0, 0, 2});
  scene.images.push_back({"", 2, 1, 4, std::vector<std::uint8_t>{255, 255, 255, 255, 255, 255, 255, 0}});
  Texture nearest;
  nearest.filter = TexelFilter::nearest;
  scene.textures.push_back(nearest);
  scene.materials[1].base_colour_texture = TextureRef{};
  scene.materials[1].alpha_mode = AlphaMode::mask;
  add_mesh_lamp(scene, mesh);
  const double half = 3 * lambert_sum(Vec3d(0), {{-1, 2, -1}, {0, 2, -1}, {0, 2, 1}, {-1, 2, 1}});
  expect_irradiance(scene, half);
  scene.materials[1].alpha_mode = AlphaMode::blend;
  scene.materials[1].alpha = 0.25F;
  expect_irradiance(scene, 0.25 * half);
}

TEST(LightSampler, UnlitSurfacesAreNoLamps) {
  Scene scene = scene_with_lamp();
  scene.materials[1].unlit = true;
  add_mesh_lamp(scene, rectangle({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}));
  scene.shapes.push_back({"", Sphere{{0, 4, 0}, 1}, 1});
  EXPECT_EQ(LightSampler(scene).light_count(), 0U);
}

TEST(LightSampler, AnEvenEnvironment) {
  Scene scene = scene_with_lamp();
  scene.environment = Environment{};
  scene.environment->radiance = Rgb(2);
  expect_irradiance(scene, pi * 2);
  scene.environment->backdrop_only = true;
  EXPECT_EQ(LightSampler(scene).light_count(), 0U);
}

/// A sky of 16 x 8 texels, float, with a sun.
Scene picture_sky() {
  Scene scene = scene_with_lamp();
  Dice dice(4);
  std::vector<float> texels;
  for (int i = 0; i < 16 * 8 * 3; ++i) texels.push_back(static_cast<float>(dice.between(0, 1)));
  for (int c = 0; c < 3; ++c) texels[static_cast<std::size_t>((2 * 16 + 5) * 3 + c)] = 40;
  scene.images.push_back({"sky", 16, 8, 3, texels});
  scene.environment = Environment{};
  scene.environment->radiance = Rgb(0.5F, 2, 1);
  scene.environment->image = 0;
  return scene;
}

/// Sums `f(direction)` over solid angle by the midpoints of a fine grid of angles that respects the texels.
template <class F>
double over_sphere(F&& f, int rows = 8 * 60, int columns = 16 * 60) {
  double sum = 0;
  for (int y = 0; y < rows; ++y) {
    const double theta = pi * (y + 0.5) / rows;
    for (int x = 0; x < columns; ++x) {
      const double phi = 2 * pi * (x + 0.5) / columns;
      const Vec3d d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      sum += f(d) * std::sin(theta);
    }
  }
  return sum * (pi / rows) * (2 * pi / columns);
}

TEST(LightSampler, APictureEnvironmentByQuadrature) {
  const Scene scene = picture_sky();
  const EnvironmentMap map(scene);
  expect_irradiance(scene, over_sphere([&](const Vec3d& d) { return std::max(0.0, d.y) * map.radiance(d).y; }));
  EXPECT_NEAR(over_sphere([&](const Vec3d& d) { return map.radiance(d).x; }) / (4 * pi), map.mean_radiance().x,
              0.02 * map.mean_radiance().x);
}

TEST(EnvironmentMap, DensityIntegratesToOneAndIsThatOfItsSamples) {
  const Scene scene = picture_sky();
  const EnvironmentMap map(scene);
  EXPECT_NEAR(over_sphere([&](const Vec3d& d) { return map.pdf(d); }), 1, 1e-4);
  Dice dice(5);
  // Where samples fall, octant by octant, against the integral of the density there.
  double shares[8] = {};
  constexpr int samples = 40000;
  const auto octant = [](const Vec3d& d) { return (d.x > 0 ? 1 : 0) + (d.y > 0 ? 2 : 0) + (d.z > 0 ? 4 : 0); };
  for (int i = 0; i < samples; ++i) {
    const auto s = map.sample(dice.square());
    ASSERT_NEAR(length(s.direction), 1, 1e-12);
    ASSERT_NEAR(s.pdf, map.pdf(s.direction), 1e-9 * s.pdf);
    shares[octant(s.direction)] += 1.0 / samples;
  }
  for (int o = 0; o < 8; ++o) {
    const double truth = over_sphere([&](const Vec3d& d) { return octant(d) == o ? map.pdf(d) : 0; });
    EXPECT_NEAR(shares[o], truth, 4 * std::sqrt(truth / samples));
  }
}

TEST(EnvironmentMap, TheMiddleOfThePictureIsTowardsMinusZ) {
  Scene scene;
  std::vector<float> texels(4 * 2 * 3, 0.0F);
  const auto set = [&](int x, int y, float v) { texels[static_cast<std::size_t>((y * 4 + x) * 3)] = v; };
  set(1, 0, 1), set(2, 0, 2), set(3, 0, 3), set(0, 0, 4), set(2, 1, 5);
  scene.images.push_back({"sky", 4, 2, 3, texels});
  scene.environment = Environment{};
  scene.environment->image = 0;
  const EnvironmentMap map(scene);
  EXPECT_EQ(map.radiance(normalize(Vec3d(0.1, 0.5, -1))).x, 2) << "right of the middle";
  EXPECT_EQ(map.radiance(normalize(Vec3d(-0.1, 0.5, -1))).x, 1) << "left of it";
  EXPECT_EQ(map.radiance(normalize(Vec3d(0.1, 0.5, 1))).x, 3) << "behind, right";
  EXPECT_EQ(map.radiance(normalize(Vec3d(-0.1, 0.5, 1))).x, 4) << "behind, left";
  EXPECT_EQ(map.radiance(normalize(Vec3d(0.1, -0.5, -1))).x, 5) << "below";
}

/// Lamps of every kind, each seen from the origin without another before it.
Scene all_lamps() {
  Scene scene = scene_with_lamp();
  scene.materials[1].double_sided = true;
  add_mesh_lamp(scene, rectangle({-1, 2, -5}, {2, 0, 0}, {0, 1, 0}));
  add_mesh_lamp(scene, rectangle({2, 1, -1}, {0, 1, 0.2}, {0.3, 0, 1}));
  scene.shapes.push_back({"", Sphere{{0, 5, 0}, 1}, 1});
  scene.shapes.push_back({"", Disk{{-4, 1, 0}, normalize(Vec3d(1, 0.3, 0)), 1}, 1});
  scene.shapes.push_back({"", Cylinder{{-1, 1, 4}, {1, 1.5, 4}, 0.4}, 1});
  return scene;
}

TEST(LightSampler, PdfIsTheDensityOfSampling) {
  for (const bool sky : {false, true}) {
    Scene scene = all_lamps();
    if (sky) scene.environment = picture_sky().environment, scene.images = picture_sky().images;
    const LightSampler lights(scene);
    const RayTracer tracer(scene);
    const SurfacePoint at = receiver();
    Dice dice(6);
    int objects = 0, skies = 0;
    for (int i = 0; i < 20000; ++i) {
      const double u = dice.unit();
      const auto s = lights.sample(at, u, dice.square());
      if (!s || s->pdf <= 0) continue;
      const Ray ray{.origin = at.position, .direction = s->direction};
      const auto hit = tracer.nearest(ray);
      if (!hit) {
        if (std::isfinite(s->shadow_ray.t_max)) continue;  // beside a lamp's silhouette, by rounding
        ASSERT_NEAR(lights.environment_pdf(s->direction), s->pdf, 1e-6 * s->pdf);
        ++skies;
        continue;
      }
      if (s->shadow_ray.t_max > hit->t * 1.001) continue;  // the far side of the lamp, or the sky behind it
      const double pdf = lights.pdf(at.position, tracer.surface_point(ray, *hit));
      // Seen edge on the density of area goes to infinity, and rounding is all there is.
      const double cosine = std::abs(dot(tracer.surface_point(ray, *hit).geometric_normal, s->direction));
      if (cosine > 0.05) {
        ASSERT_NEAR(pdf, s->pdf, 1e-3 * s->pdf) << "object " << hit->object;
      }
      ++objects;
    }
    EXPECT_GT(objects, 1000);
    EXPECT_EQ(skies > 1000, sky);
  }
}

// Summed over all directions the density is the chance to choose a light at all: every lamp is seen whole here, but for
// the cylinder, half of whose points are behind.
TEST(LightSampler, PdfIntegratesToTheChanceOfChoosing) {
  Scene scene = all_lamps();
  scene.shapes.pop_back();
  const LightSampler lights(scene);
  const RayTracer tracer(scene);
  Dice dice(7);
  const Estimate e = monte_carlo(200000, [&] {
    const Ray ray{.origin = Vec3d(0), .direction = dice.direction()};
    const auto hit = tracer.nearest(ray);
    return hit ? 4 * pi * lights.pdf(ray.origin, tracer.surface_point(ray, *hit)) : 0.0;
  });
  EXPECT_NEAR(e.mean, 1, 4 * e.error);
  EXPECT_LT(e.error, 0.02);
}

TEST(LightSampler, AmbientLightIsKeptApart) {
  Scene scene = scene_with_lamp();
  scene.lights.push_back({"", AmbientLight{Rgb(0.1F)}});
  scene.lights.push_back({"", AmbientLight{Rgb(0.2F)}});
  const LightSampler lights(scene);
  EXPECT_EQ(lights.light_count(), 0U);
  EXPECT_FLOAT_EQ(lights.ambient().x, 0.3F);
  EXPECT_FALSE(lights.sample(receiver(), 0.5, {0.5, 0.5}));
}

TEST(LightSampler, MiddlesOfFlatLamps) {
  Scene scene = scene_with_lamp();
  add_mesh_lamp(scene, rectangle({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}));
  scene.shapes.push_back({"", Disk{{0, 3, 0}, {0, -1, 0}, 0.5}, 1});
  scene.shapes.push_back({"", Sphere{{0, 3, 3}, 0.5}, 1});
  add_mesh_lamp(scene, testing::box({5, 5, 5}, {6, 6, 6}));
  const LightSampler lights(scene);
  const Vec3d towards[] = {{0, 2, 0}, {0, 0, 0}, {0, 3, 0}, {0, 3, 3}};
  for (const std::size_t i : {0U, 2U, 3U}) {
    ASSERT_TRUE(lights.has_middle(i)) << i;
    const auto s = lights.sample_middle(i, receiver());
    ASSERT_TRUE(s) << i;
    EXPECT_GT(dot(s->direction, normalize(towards[i])), 1 - 1e-9) << i;
  }
  EXPECT_FALSE(lights.has_middle(1)) << "a box has no flat middle";
  // One sample of area A at distance d: L A cos cos / d^2.
  EXPECT_NEAR(lights.sample_middle(0, receiver())->weight().y, 3 * 4 / 4.0, 1e-5);
}

}  // namespace
}  // namespace penumbra
