#include "penumbra/tracing/shading/shadow.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/tracing/shading/fresnel.h"
#include "tracing/soup.h"

namespace penumbra {
namespace {

using testing::box;
using testing::rectangle;
using testing::scene_of;

/// A slab of coloured glass between y = 0 and y = 0.5.
Scene slab() {
  Scene scene = scene_of(box({-10, 0, -10}, {10, 0.5, 10}));
  Material& glass = scene.materials[0];
  glass.base_colour = Rgb(1);
  glass.transmission = 1;
  glass.roughness = 0;
  glass.ior = 1.5F;
  glass.attenuation_colour = {0.9F, 0.5F, 0.1F};
  glass.attenuation_distance = 0.25F;
  return scene;
}

Ray down(double angle = 0) {
  return {.origin = {0.1, 1, 0.2}, .direction = {std::sin(angle), -std::cos(angle), 0}, .t_max = 10};
}

TEST(Shadow, GlassAttenuatesStraightThrough) {
  const Scene scene = slab();
  const RayTracer tracer(scene);
  const Shadow shadow(tracer, true);
  EXPECT_FALSE(shadow.is_binary());
  for (const double angle : {0.0, 0.5, 1.0}) {
    const double reflected = fresnel_dielectric(std::cos(angle), 1, 1.5).mean();
    const double way = 0.5 / std::cos(angle);
    const Rgb passed = shadow.transmittance(down(angle));
    for (int c = 0; c < 3; ++c) {
      const double sigma = -std::log(static_cast<double>(scene.materials[0].attenuation_colour[c])) / 0.25;
      const double truth = (1 - reflected) * (1 - reflected) * std::exp(-sigma * way);
      EXPECT_NEAR(passed[c], truth, 1e-5) << angle;
    }
  }
}

TEST(Shadow, OpaqueShadowsStopAtGlass) {
  const Scene scene = slab();
  const RayTracer tracer(scene);
  const Shadow shadow(tracer, false);
  EXPECT_TRUE(shadow.is_binary());
  EXPECT_EQ(shadow.transmittance(down()), Rgb(0));
  Ray short_of_it = down();
  short_of_it.t_max = 0.4;
  EXPECT_EQ(shadow.transmittance(short_of_it), Rgb(1));
}

TEST(Shadow, ThinGlassIsAPlate) {
  Scene scene = scene_of(rectangle({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}));
  Material& glass = scene.materials[0];
  glass.base_colour = {1, 0.5F, 1};
  glass.transmission = 1;
  glass.thin_walled = true;
  const RayTracer tracer(scene);
  const Rgb passed = Shadow(tracer, true).transmittance(down());
  EXPECT_NEAR(passed.x, fresnel_plate(1, 1.5).transmittance, 1e-6);
  EXPECT_NEAR(passed.y, 0.5 * fresnel_plate(1, 1.5).transmittance, 1e-6);
}

TEST(Shadow, BlendedSheetsPassTheRest) {
  Mesh sheets;
  for (int i = 0; i < 5; ++i) {
    const Mesh one = rectangle({-1, 0.1 * i, -1}, {2, 0, 0}, {0, 0, 2});
    const auto first = static_cast<std::uint32_t>(sheets.positions.size());
    sheets.positions.insert(sheets.positions.end(), one.positions.begin(), one.positions.end());
    for (const auto& [a, b, c] : one.triangles) sheets.triangles.push_back({first + a, first + b, first + c});
  }
  Scene scene = scene_of(sheets);
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].alpha = 0.3F;
  const RayTracer tracer(scene);
  for (const bool through_glass : {false, true}) {
    const Shadow shadow(tracer, through_glass);
    EXPECT_NEAR(shadow.transmittance(down()).x, std::pow(0.7, 5), 1e-6);
    Ray after_two = down();
    after_two.t_max = 1 - 0.35 + 1e-9;
    EXPECT_EQ(shadow.transmittance(after_two).x, 1 * 0.7F) << "one sheet, at 0.4, stands before 0.35";
  }
}

TEST(Shadow, SheetsInsideGlassDoNotShortenTheWayThroughIt) {
  Scene scene = slab();
  scene.materials.emplace_back();
  scene.materials[1].alpha_mode = AlphaMode::blend;
  scene.materials[1].alpha = 0.5F;
  scene.meshes.push_back(rectangle({-1, 0.25, -1}, {2, 0, 0}, {0, 0, 2}));
  scene.meshes[1].materials = {1};
  const RayTracer clear(scene);
  const Rgb without = Shadow(clear, true).transmittance(down());
  scene.instances.push_back({"sheet", 1, Mat4d(1.0)});
  const RayTracer tracer(scene);
  const Rgb with = Shadow(tracer, true).transmittance(down());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(with[c], 0.5 * without[c], 1e-6);
}

TEST(Shadow, OpaqueThingsBehindGlassStopEverything) {
  Scene scene = slab();
  scene.materials.emplace_back();
  scene.shapes.push_back({"", Sphere{{0, -2, 0}, 0.5}, 1});
  const RayTracer tracer(scene);
  const Shadow shadow(tracer, true);
  EXPECT_EQ(shadow.transmittance(down()), Rgb(0));
  Ray above = down();
  above.t_max = 2;
  EXPECT_GT(shadow.transmittance(above).x, 0.5);
}

}  // namespace
}  // namespace penumbra
