#include "penumbra/render/ray_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "penumbra/render/camera_rays.h"
#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;
using Kind = TreeRay::Kind;
using End = TreeRay::End;

float largest_difference(const Rgb& a, const Rgb& b) { return max_component(glm::abs(a - b)); }

std::size_t count(const RayTree& tree, Kind kind, End end) {
  return static_cast<std::size_t>(std::count_if(tree.rays.begin(), tree.rays.end(),
                                                [&](const TreeRay& r) { return r.kind == kind && r.end == end; }));
}

// The tree's own light, weighed, is the pixel that whitted draws; and each hit's parts sum to 1.
TEST(RayTree, IsThePixelOfWhitted) {
  for (const char* name : {"whitted", "cornell-spheres", "cornell-box"}) {
    const Scene scene = make_builtin_scene(name);
    const RayTracer tracer(scene);
    RenderOptions options;
    options.samples_per_pixel = 1;
    options.width = 24;
    options.height = 18;
    const Image picture = render(tracer, scene.cameras.at(0), options).image;
    const CameraRays rays(scene.cameras[0], options.width, options.height, FilterKind::box, 1);
    for (int y = 0; y < options.height; ++y) {
      for (int x = 0; x < options.width; ++x) {
        const Ray primary = rays.through(x + 0.5, y + 0.5);
        const RayTree tree = make_ray_tree(tracer, primary, {.differential = rays.differential(primary)});
        // The picture averages its chequers in single precision, here through a glass ball's rim.
        ASSERT_LT(largest_difference(tree.radiance, picture.rgb(x, y)), 1e-3F * (1 + max_component(tree.radiance)))
            << name << " " << x << " " << y;
        ASSERT_LT(largest_difference(tree.rays[0].radiance * tree.rays[0].weight, tree.radiance),
                  1e-4F * (1 + max_component(tree.radiance)));
        for (std::size_t i = 0; i < tree.rays.size(); ++i) {
          const TreeRay& ray = tree.rays[i];
          ASSERT_LT(ray.parent, static_cast<std::int32_t>(i));
          if (!ray.split) continue;
          const Rgb sum = ray.split->reflected + ray.split->refracted + ray.split->diffuse + ray.split->absorbed;
          EXPECT_LT(largest_difference(sum, Rgb(1)), 1e-6F);
        }
      }
    }
  }
}

// A mirror in front of the eye, its back wall lit by a point light that a ball hides.
TEST(RayTree, SaysWhatEveryRayMetAndWhyItEnded) {
  Scene scene;
  add_plane(scene, {0, 0, -2}, {0, 0, 1}, mirror(Rgb(0.5F)));
  add_plane(scene, {0, 0, 3}, {0, 0, -1}, matt(Rgb(0.4F)));
  add_shape(scene, Sphere{{0, 1, 2}, 0.2}, matt(Rgb(0)));
  PointLight light;
  light.position = {0, 2, 1};
  light.intensity = Rgb(3);
  scene.lights.push_back({"lamp", light});
  const RayTracer tracer(scene);
  const RayTree tree = make_ray_tree(tracer, {.origin = {0, 0, 0}, .direction = {0, 0, -1}});
  ASSERT_EQ(tree.rays.size(), 3U);
  EXPECT_EQ(tree.rays[0].kind, Kind::primary);
  EXPECT_EQ(tree.rays[0].length, 2);
  EXPECT_EQ(tree.rays[0].object, 0);
  EXPECT_LT(largest_difference(tree.rays[0].split->reflected, Rgb(0.5F)), 1e-6F);
  EXPECT_LT(largest_difference(tree.rays[0].split->absorbed, Rgb(0.5F)), 1e-6F);
  EXPECT_EQ(tree.rays[1].kind, Kind::reflection);
  EXPECT_NEAR(tree.rays[1].length, 5, 1e-5);
  EXPECT_EQ(tree.rays[1].object, 1);
  EXPECT_LT(largest_difference(tree.rays[1].weight, Rgb(0.5F)), 1e-6F);
  EXPECT_EQ(tree.rays[2].kind, Kind::shadow);
  EXPECT_EQ(tree.rays[2].parent, 1);
  EXPECT_EQ(tree.rays[2].end, End::hidden);
  EXPECT_EQ(tree.rays[2].object, 2);
  EXPECT_NEAR(tree.rays[2].length, std::sqrt(2.0) - 0.2, 1e-5);
  EXPECT_EQ(max_component(tree.radiance), 0);
}

TEST(RayTree, RaysThatWouldCarryTooLittleAreNamed) {
  Scene scene;  // two mirrors face to face
  add_plane(scene, {0, 0, -1}, {0, 0, 1}, mirror(Rgb(0.1F)));
  add_plane(scene, {0, 0, 1}, {0, 0, -1}, mirror(Rgb(0.1F)));
  const RayTracer tracer(scene);
  const Ray along{.origin = {0, 0, 0}, .direction = {0, 0, -1}};
  const RayTree weak = make_ray_tree(tracer, along, {.max_depth = 100, .min_throughput = 0.05e-2});
  EXPECT_EQ(count(weak, Kind::reflection, End::surface), 3U);  // 0.1, 0.01, 0.001
  EXPECT_EQ(count(weak, Kind::reflection, End::energy_spent), 1U);
  const RayTree deep = make_ray_tree(tracer, along, {.max_depth = 2, .min_throughput = 0});
  EXPECT_EQ(count(deep, Kind::reflection, End::surface), 2U);
  EXPECT_EQ(count(deep, Kind::reflection, End::too_deep), 1U);
}

// At normal incidence on glass, R = 0.04: reflection goes home, refraction on, each with its Fresnel share.
TEST(RayTree, GlassSplitsByFresnel) {
  Scene scene;
  add_shape(scene, Sphere{{0, 0, -3}, 1}, glass(1.5F));
  const RayTracer tracer(scene);
  const RayTree tree = make_ray_tree(tracer, {.origin = {0, 0, 0}, .direction = {0, 0, -1}});
  EXPECT_NEAR(tree.rays[0].split->reflected.x, 0.04, 1e-6);
  EXPECT_NEAR(tree.rays[0].split->refracted.x, 0.96, 1e-6);
  EXPECT_EQ(tree.rays[1].kind, Kind::reflection);
  EXPECT_EQ(tree.rays[1].end, End::left_scene);
  EXPECT_TRUE(std::isinf(tree.rays[1].length));
  EXPECT_EQ(tree.rays[2].kind, Kind::refraction);
  EXPECT_NEAR(tree.rays[2].length, 2, 1e-5);
  EXPECT_FALSE(tree.rays[2].front);
}

}  // namespace
}  // namespace penumbra
