// What every integrator must agree on: direct light, blending, sides, layers, ray counts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

RenderOptions appel(int samples = 1) {
  RenderOptions options = whitted(samples);
  options.integrator = IntegratorKind::appel;
  return options;
}

// Under a disk, off and on its axis, and a rectangle by Lambert's sum; the lamp is black, so nothing comes back.
TEST(Integrators, AgreeOnALampOverAMattFloor) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.6F)));
  add_shape(scene, Disk{{0, 2, 0}, {0, -1, 0}, 0.8}, glow(Rgb(5)));
  const RayTracer tracer(scene);
  const double irradiance = pi * 5 * 0.64 / (0.64 + 4);
  const double truth = 0.6 / pi * irradiance;
  for (const RenderOptions& options : {appel(4096), whitted(4096), path(4096)}) {
    const Seen seen = look(tracer, {3, 1, 0}, {-3, -1, 0}, options);
    EXPECT_NEAR(seen.value, truth, 4 * seen.error) << static_cast<int>(options.integrator);
    EXPECT_LT(seen.error, 0.01 * truth);
  }
}

TEST(Integrators, AgreeOnShadows) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  add_shape(scene, Sphere{{0, 1, 0}, 0.5}, matt(Rgb(0)));
  PointLight light;
  light.position = {0, 3, 0};
  light.intensity = Rgb(9);
  scene.lights.push_back({"", light});
  const RayTracer tracer(scene);
  // The ball's shadow is a cone of sine 0.5 / 2: on the floor a disk of radius 3 tan.
  const double edge = 3 * 0.25 / std::sqrt(1 - 0.0625);
  for (const RenderOptions& options : {appel(4), whitted(4), path(4)}) {
    EXPECT_EQ(look(tracer, {edge - 1e-3, 0.3, 0.3}, {0, -1, -1}, options).value, 0);
    const double x = edge + 1e-3;
    const double distance2 = 9 + x * x;
    const double truth = 0.5 / pi * 9 / distance2 * 3 / std::sqrt(distance2);
    EXPECT_NEAR(look(tracer, {x, 0.3, 0.3}, {0, -1, -1}, options).value, truth, 1e-5);
  }
}

TEST(Integrators, ShineThroughBlendedSheets) {
  Scene scene;
  add_plane(scene, {0, -1, 0}, {0, 1, 0}, glow(Rgb(4)));
  Material sheet;
  sheet.unlit = true;
  sheet.base_colour = Rgb(0.5F);
  sheet.alpha = 0.25F;
  sheet.alpha_mode = AlphaMode::blend;
  add_mesh(scene, rectangle({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), sheet);
  add_mesh(scene, rectangle({-1, 0.5, 1}, {2, 0, 0}, {0, 0, -2}), sheet);
  const RayTracer tracer(scene);
  const double under_one = 0.25 * 0.5 + 0.75 * 4;
  const double truth = 0.25 * 0.5 + 0.75 * under_one;
  EXPECT_NEAR(look(tracer, {0, 2, 0}, {0.1, -1, 0}, whitted()).value, truth, 1e-5);
  const Seen p = look(tracer, {0, 2, 0}, {0.1, -1, 0}, path(4096));
  EXPECT_NEAR(p.value, truth, 4 * p.error);
}

// A half-transparent lamp: light sampling and the rays that find it must tell the same.
TEST(Integrators, BlendedLampsShineByTheirAlpha) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  Material lamp = glow(Rgb(4));
  lamp.alpha = 0.5F;
  lamp.alpha_mode = AlphaMode::blend;
  add_shape(scene, Disk{{0, 1, 0}, {0, -1, 0}, 1}, lamp);
  const RayTracer tracer(scene);
  const double truth = 0.5 / pi * 0.5 * (pi * 4 * 0.5);
  for (const RenderOptions& options : {whitted(4096), path(8192)}) {
    const Seen seen = look(tracer, {1, 0.5, 0}, {-1, -0.5, 0}, options);
    EXPECT_NEAR(seen.value, truth, 4 * seen.error) << static_cast<int>(options.integrator);
    EXPECT_LT(seen.error, 0.02 * truth);
  }
}

TEST(Integrators, ShowUnlitSurfacesAsTheyAre) {
  Scene scene;
  Material unlit;
  unlit.unlit = true;
  unlit.base_colour = {0.2F, 0.5F, 0.8F};
  unlit.emission = Rgb(7);
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, unlit);
  PointLight light;
  light.position = {0, 3, 0};
  light.intensity = Rgb(100);
  scene.lights.push_back({"", light});
  const RayTracer tracer(scene);
  for (const RenderOptions& options : {appel(), whitted(), path(4)}) {
    for (const double side : {1.0, -1.0}) {
      const Rgb seen = look(tracer, {0, side, 0}, {0.2, -side, 0.1}, options).radiance;
      EXPECT_LT(length(seen - unlit.base_colour), 1e-6F) << static_cast<int>(options.integrator);
    }
  }
}

TEST(Integrators, FrontSidesOnlyMakesBacksBlack) {
  Scene scene;
  scene.environment = Environment{};
  add_mesh(scene, rectangle({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), matt(Rgb(0.5F)));
  const RayTracer tracer(scene);
  for (RenderOptions options : {appel(16), whitted(16), path(64)}) {
    for (const bool front_only : {false, true}) {
      options.front_sides_only = front_only;
      EXPECT_NEAR(look(tracer, {0, 1, 0}, {0, -1, 0}, options).value, 0.5, 0.1);
      const double back = look(tracer, {0, -1, 0}, {0, 1, 0}, options).value;
      EXPECT_NEAR(back, front_only ? 0 : 0.5, front_only ? 0 : 0.1);
    }
  }
}

TEST(Integrators, EmitFromTheFrontOnlyUnlessDoubleSided) {
  for (const bool both : {false, true}) {
    Scene scene;
    Material lamp = glow(Rgb(2));
    lamp.double_sided = both;
    add_mesh(scene, rectangle({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), lamp);
    const RayTracer tracer(scene);
    for (const RenderOptions& options : {appel(), whitted(), path(4)}) {
      EXPECT_FLOAT_EQ(static_cast<float>(look(tracer, {0, 1, 0}, {0, -1, 0}, options).value), 2);
      EXPECT_FLOAT_EQ(static_cast<float>(look(tracer, {0, -1, 0}, {0, 1, 0}, options).value), both ? 2 : 0);
    }
  }
}

TEST(Integrators, CountRaysByWhatTheyAreFor) {
  Scene scene;
  add_mesh(scene, rectangle({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}), matt(Rgb(0.5F)));
  PointLight light;
  light.position = {0, 3, 0};
  scene.lights.push_back({"", light});
  scene.lights.push_back({"", DirectionalLight{{0, -1, 0}, Rgb(1)}});
  PointLight below = light;
  below.position = {0, -3, 0};  // behind the surface: no ray is sent
  scene.lights.push_back({"", below});
  const RayTracer tracer(scene);
  // Looking down from above, everything in the picture is floor; looking up, nothing is.
  Camera camera{.name = "", .to_world = look_at({0, 2, 0}, {0, 0, 0}, {1, 0, 0}), .lens = PerspectiveLens{0.5}};
  for (RenderOptions options : {appel(3), whitted(3)}) {
    options.width = 7;
    options.height = 5;
    const RayCounts rays = render(tracer, camera, options).rays;
    EXPECT_EQ(rays.primary, 7U * 5 * 3);
    EXPECT_EQ(rays.shadow, 2U * 7 * 5 * 3);
    EXPECT_EQ(rays.reflection + rays.refraction + rays.diffuse, 0U);
    EXPECT_EQ(rays.total(), 3U * 7 * 5 * 3);
    ASSERT_EQ(rays.by_depth.size(), 1U);
    EXPECT_EQ(rays.by_depth[0], rays.total());
  }
  camera.to_world = look_at({0, 2, 0}, {0, 4, 0}, {1, 0, 0});
  for (RenderOptions options : {appel(3), whitted(3), path(3)}) {
    options.width = 7;
    options.height = 5;
    const RayCounts rays = render(tracer, camera, options).rays;
    EXPECT_EQ(rays.primary, 7U * 5 * 3);
    EXPECT_EQ(rays.total(), 7U * 5 * 3);
  }
}

TEST(Integrators, GlassCountsAReflectionAndARefraction) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, glass(1.5F));
  const RayTracer tracer(scene);
  const RayCounts rays = look(tracer, {0, 1, 0}, {0.3, -1, 0}, whitted()).rays;
  EXPECT_EQ(rays.primary, 1U);
  EXPECT_EQ(rays.reflection, 1U);
  EXPECT_EQ(rays.refraction, 1U);
  EXPECT_EQ(rays.shadow, 0U);
  EXPECT_EQ(rays.by_depth, (std::vector<std::uint64_t>{1, 2}));
}

std::size_t channel(const Image& image, const std::string& name) {
  const auto at = std::find(image.channels.begin(), image.channels.end(), name);
  EXPECT_NE(at, image.channels.end()) << name;
  return static_cast<std::size_t>(at - image.channels.begin());
}

TEST(Layers, TellTheFirstSurface) {
  Scene scene;
  scene.environment = Environment{};
  scene.environment->radiance = Rgb(0.25F);
  add_mesh(scene, rectangle({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}), matt({0.5F, 0.3F, 0.1F}), "floor");
  add_shape(scene, Sphere{{0, 1, 0}, 1}, matt({0.1F, 0.7F, 0.2F}));
  const RayTracer tracer(scene);
  const Camera camera{.name = "", .to_world = look_at({0, 2, 8}, {0, 1, 0}, {0, 1, 0}), .lens = PerspectiveLens{1.0}};
  constexpr int w = 24, h = 18;
  for (RenderOptions options : {appel(), whitted(), path(1)}) {
    options.width = w;
    options.height = h;
    options.aovs = {Aov::albedo, Aov::normal, Aov::depth, Aov::position, Aov::object, Aov::direct, Aov::indirect};
    const Image image = render(tracer, camera, options).image;
    int balls = 0, floors = 0, skies = 0;
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const float* p = image.pixel(x, y);
        const auto vector = [&](const char* layer, const char* parts) {
          Vec3d v;
          for (int c = 0; c < 3; ++c) v[c] = p[channel(image, std::string(layer) + "." + parts[c])];
          return v;
        };
        const Ray ray = camera.ray((x + 0.5) / w, (y + 0.5) / h, static_cast<double>(w) / h);
        const auto hit = tracer.nearest(ray);
        const Vec3d sum = vector("direct", "RGB") + vector("indirect", "RGB");
        ASSERT_LT(length(sum - Vec3d(image.rgb(x, y))), 1e-5);
        if (!hit) {
          ++skies;
          ASSERT_EQ(p[channel(image, "object.id")], -1);
          ASSERT_TRUE(std::isinf(p[channel(image, "depth.Z")]));
          ASSERT_LT(length(Vec3d(image.rgb(x, y)) - Vec3d(0.25)), 1e-6);
          continue;
        }
        const SurfacePoint truth = tracer.surface_point(ray, *hit);
        (hit->object == 0 ? floors : balls)++;
        ASSERT_EQ(p[channel(image, "object.id")], static_cast<float>(hit->object));
        ASSERT_NEAR(p[channel(image, "depth.Z")], hit->t, 1e-5 * hit->t);
        ASSERT_LT(length(vector("position", "XYZ") - truth.position), 1e-5);
        ASSERT_LT(length(vector("normal", "XYZ") - truth.geometric_normal), 1e-5);
        ASSERT_LT(length(vector("albedo", "RGB") - Vec3d(scene.materials[truth.material].base_colour)), 1e-5);
      }
    }
    EXPECT_GT(balls, 10);
    EXPECT_GT(floors, 50);
    EXPECT_GT(skies, 50);
  }
}

// Where the rays go: the layer's pixels sum to the report's count.
TEST(Layers, RaysAddUpToTheCount) {
  Scene scene;
  add_mesh(scene, rectangle({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}), matt({0.5F, 0.3F, 0.1F}));
  add_shape(scene, Sphere{{0, 1, 0}, 1}, glass(1.5F));
  add_shape(scene, Disk{{0, 5, 0}, {0, -1, 0}, 1}, glow(Rgb(4)));
  const RayTracer tracer(scene);
  const Camera camera{.name = "", .to_world = look_at({0, 2, 8}, {0, 1, 0}, {0, 1, 0}), .lens = PerspectiveLens{1.0}};
  for (RenderOptions options : {appel(4), whitted(4), path(4)}) {
    options.width = options.height = 16;
    options.max_depth = options.integrator == IntegratorKind::whitted ? 4 : 0;
    options.aovs = {Aov::rays};
    const RenderResult result = render(tracer, camera, options);
    double sum = 0;
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) sum += 4.0 * result.image.pixel(x, y)[3];
    }
    EXPECT_NEAR(sum, static_cast<double>(result.rays.total()), 1e-3);
    std::uint64_t by_depth = 0;
    for (const std::uint64_t n : result.rays.by_depth) by_depth += n;
    EXPECT_EQ(by_depth, result.rays.total());
    EXPECT_EQ(result.rays.primary, 16U * 16 * 4);
  }
}

TEST(Layers, DepthIsMeasuredFromTheEyeThroughBlendedSheets) {
  Scene scene;
  Material sheet = matt(Rgb(1));
  sheet.alpha = 0;
  sheet.alpha_mode = AlphaMode::blend;
  add_mesh(scene, rectangle({-1, 1, 1}, {2, 0, 0}, {0, 0, -2}), sheet);
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  const RayTracer tracer(scene);
  RenderOptions options = path(1);
  options.width = options.height = 1;
  options.aovs = {Aov::depth};
  const Image image = render(tracer, probe_camera({0, 3, 0}, {0, -1, 0}), options).image;
  EXPECT_NEAR(image.pixel(0, 0)[3], 3, 1e-5);
}

// Packets of sixteen rays and single rays draw the same numbers and differ by rounding alone; layers need single ones.
TEST(Appel, PacketsAndSingleRaysDrawTheSamePicture) {
  Scene scene;
  add_mesh(scene, rectangle({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), matt({0.5F, 0.3F, 0.1F}));
  add_mesh(scene, geodesic_sphere({0, 0.7, 0}, 0.7, 3), matt({0.1F, 0.7F, 0.2F}));
  add_mesh(scene, rectangle({-1, 3, -1}, {2, 0, 0}, {0, 0, 2}), glow(Rgb(6)));
  Mat4d mirrored(1.0);
  mirrored[0].x = -1;
  mirrored[3] = {1.5, 0.3, 0.5, 1};
  scene.instances.push_back({"copy", 1, mirrored});
  scene.meshes.push_back(box({-0.3, 0, -0.3}, {0.3, 0.6, 0.3}));
  scene.instances.push_back({"box", 3, mirrored});
  scene.instances.back().to_world[3] = {-1.5, 0, 0.5, 1};
  PointLight light;
  light.position = {2, 2, 2};
  light.intensity = Rgb(3, 4, 5);
  scene.lights.push_back({"", light});
  const RayTracer tracer(scene);
  const Camera camera{.name = "", .to_world = look_at({0, 2, 5}, {0, 0.5, 0}, {0, 1, 0}), .lens = PerspectiveLens{0.8}};
  for (const int samples : {1, 4}) {
    RenderOptions options = appel(samples);
    options.width = 61;
    options.height = 47;
    const RenderResult packets = render(tracer, camera, options);
    options.aovs = {Aov::depth};
    const RenderResult single = render(tracer, camera, options);
    EXPECT_NEAR(static_cast<double>(packets.rays.total()), static_cast<double>(single.rays.total()), 20);
    int different = 0;
    for (int y = 0; y < 47; ++y) {
      for (int x = 0; x < 61; ++x) {
        const Rgb a = packets.image.rgb(x, y), b = single.image.rgb(x, y);
        different += length(a - b) > 1e-3F * (0.1F + length(b)) ? 1 : 0;
      }
    }
    EXPECT_LE(different, 61 * 47 / 200) << samples << " samples";  // edges, by rounding
  }
}

}  // namespace
}  // namespace penumbra
