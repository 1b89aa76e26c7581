// Surfaces under measured luminaires and under the disk of the sun.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "penumbra/render/render.h"
#include "penumbra/scene/luminaire.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using testing::look;
using testing::matt;
using testing::path;
using testing::Seen;
using testing::whitted;

// E = I cos / d^2 (lx), and what a matt surface sends on of it is rho E / pi.
TEST(Luminaire, IlluminanceByTheInverseSquareOfItsCandela) {
  Scene scene;
  testing::add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  scene.lights.push_back({.name = "lamp", .kind = PointLight{.position = {0, 2, 0}, .intensity = Rgb(1)}});
  wear_web(scene, 0,
           {.name = "web", .vertical = {0, 45, 90}, .horizontal = {0, 180}, .candela = {1000, 600, 0, 1000, 200, 0}});
  validate(scene);
  const RayTracer tracer(scene);
  const auto expected = [](double candela, double distance, double cosine) {
    return 0.5 / pi * candela / 683 * cosine / (distance * distance);
  };
  const double slant = std::sqrt(8.0), diagonal = std::sqrt(0.5);
  struct Place {
    Vec3d point;
    double radiance;
  };
  // Horizontal angle 0 is -Z; the plane through both is one of symmetry, so at the side it is midway.
  for (const Place& p :
       {Place{{0, 0, 0}, expected(1000, 2, 1)}, Place{{0, 0, -2}, expected(600, slant, diagonal)},
        Place{{0, 0, 2}, expected(200, slant, diagonal)}, Place{{2, 0, 0}, expected(400, slant, diagonal)}}) {
    const Vec3d eye = p.point + Vec3d(0.1, 1, 0.1);
    for (const RenderOptions& options : {whitted(1), path(1)}) {
      EXPECT_NEAR(look(tracer, eye, p.point - eye, options).value, p.radiance, 1e-5 * p.radiance);
    }
  }
}

// A disk in the sky gives its irradiance where all of it is seen, half where its half is, and is seen itself.
TEST(Luminaire, TheDiskOfAFarLight) {
  Scene scene;
  testing::add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  const double radius = 0.05;
  scene.lights.push_back(
      {.name = "sun",
       .kind = DirectionalLight{.direction = {0, -1, 0}, .irradiance = Rgb(2), .angular_radius = radius}});
  // Hides the half with x > 0 of the disk, as seen from the origin.
  testing::add_mesh(scene, testing::rectangle({0, 1, -5}, {5, 0, 0}, {0, 0, 10}), matt(Rgb(0)), "roof");
  const RayTracer tracer(scene);
  const auto ground = [&](double x, const RenderOptions& options) {
    const Vec3d eye(x - 0.3, 0.5, 0.02);
    return look(tracer, eye, Vec3d(x, 0, 0) - eye, options);
  };
  const double whole = 0.5 * 2 / pi;
  for (const RenderOptions& options : {whitted(1024), path(1024)}) {
    EXPECT_NEAR(ground(-1, options).value, whole, 1e-3 * whole);
    EXPECT_NEAR(ground(0, options).value, whole / 2, 0.03 * whole);
    EXPECT_NEAR(ground(1, options).value, 0, 1e-9);
    const double sine = std::sin(radius);
    EXPECT_NEAR(look(tracer, {-1, 0.5, 0}, {0, 1, 0}, options).value, 2 / (pi * sine * sine), 1e-2);
    EXPECT_EQ(look(tracer, {-1, 0.5, 0}, {-0.06, 1, 0}, options).value, 0);
  }
}

}  // namespace
}  // namespace penumbra
