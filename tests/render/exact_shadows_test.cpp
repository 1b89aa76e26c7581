// Shadows of flat lamps by clipping the lamp, against closed forms and references.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "penumbra/radiosity/meshing/polygon_shadows.h"
#include "render/probe.h"
#include "test_paths.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

RenderOptions exact(IntegratorKind kind = IntegratorKind::whitted) {
  RenderOptions options = whitted(1);
  options.integrator = kind;
  options.exact_shadows = true;
  return options;
}

/// What a floor at y = 0 sends up at x.
double floor_at(const RayTracer& tracer, double x, const RenderOptions& options) {
  return look(tracer, {x + 0.05, 0.1, 0}, {-0.05, -0.1, 0}, options).value;
}

/// A lamp of width w in x and any length, at height H, and a board at height h that ends at x = 0 and hides x > 0.
Scene edge_under(double w, double h, double H, double length) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  add_mesh(scene, rectangle({-w / 2, H, -length / 2}, {w, 0, 0}, {0, 0, length}), glow(Rgb(4)));
  add_mesh(scene, rectangle({0, h, -1000}, {0, 0, 2000}, {1000, 0, 0}), matt(Rgb(0)));
  return scene;
}

nlohmann::json reference(const char* file) {
  std::ifstream in(std::string(PENUMBRA_TEST_DATA) + "/" + file);
  return nlohmann::json::parse(in);
}

// penumbra.json: between full light and none lie w h / (H - h).
TEST(ExactShadows, PenumbraIsAsWideAsGeometrySays) {
  const nlohmann::json penumbra = reference("penumbra.json");
  for (const auto& c : penumbra.at("cases")) {
    if (!c.contains("width")) continue;
    const double w = c.at("w"), h = c.at("h_o"), H = c.at("H");
    const Scene edge = edge_under(w, h, H, 2);
    const RayTracer tracer(edge);
    Scene open = edge;
    open.instances.pop_back();
    const RayTracer without(open);
    const auto share = [&](double x) { return floor_at(tracer, x, exact()) / floor_at(without, x, exact()); };
    const auto where = [&](double level, double low, double high) {  // share falls with x
      while (high - low > 1e-6) {
        const double middle = (low + high) / 2;
        (share(middle) > level ? low : high) = middle;
      }
      return (low + high) / 2;
    };
    const double begin = where(1 - 2e-6, -1, 0.1), end = where(2e-6, -0.1, 1);
    EXPECT_NEAR(end - begin, c.at("width").get<double>(), 1e-4);
    EXPECT_NEAR(begin, -end, 1e-4);
  }
}

// A far square lamp whose edge is parallel to the board's: light falls linearly.
TEST(ExactShadows, AFarSquareLampFadesLinearly) {
  constexpr double w = 1, h = 100, H = 300;
  const Scene scene = edge_under(w, h, H, w);
  const RayTracer tracer(scene);
  const double half_width = w * h / (H - h) / 2;
  const double whole = 0.5 / pi * 4 * w * w / (H * H);
  for (const double x : {-0.9, -0.5, 0.0, 0.3, 0.8}) {
    EXPECT_NEAR(floor_at(tracer, x * half_width, exact()) / whole, (1 - x) / 2, 1e-4) << x;
  }
}

// penumbra.json: a far disk, by shadow rays.
TEST(ExactShadows, AFarDiskFadesAsItsSegments) {
  constexpr double r = 0.5, h = 100, H = 300;
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  add_shape(scene, Disk{{0, H, 0}, {0, -1, 0}, r}, glow(Rgb(4)));
  add_mesh(scene, rectangle({0, h, -1000}, {0, 0, 2000}, {1000, 0, 0}), matt(Rgb(0)));
  const RayTracer tracer(scene);
  const double half_width = r * h / (H - h);
  const double whole = 0.5 * 4 * r * r / (H * H);
  int cases = 0;
  const nlohmann::json penumbra = reference("penumbra.json");
  for (const auto& c : penumbra.at("cases")) {
    if (!c.contains("x")) continue;
    ++cases;
    RenderOptions options = whitted(4096);
    const Seen seen = look(tracer, {-c.at("x").get<double>() * half_width + 0.05, 0.1, 0}, {-0.05, -0.1, 0}, options);
    EXPECT_NEAR(seen.value / whole, c.at("disk_fraction").get<double>(), 3 * seen.error / whole + 1e-4);
    EXPECT_LT(seen.error, 0.02 * whole);
  }
  EXPECT_EQ(cases, 2);
}

// Parallel rectangles with a rectangle in between, known to 25 digits: the mean of what points of one see of the other.
TEST(ExactShadows, MeansOverARectangleAreItsObstructedFormFactor) {
  const nlohmann::json factors = reference("radiosity/view_factors_obstructed.json");
  for (const auto& c : factors.at("exact_semianalytic")) {
    const auto number = [&](const nlohmann::json& v) {
      return v.is_string() ? std::stod(v.get<std::string>()) : v.get<double>();
    };
    const auto range = [&](const char* key) { return Vec2d(number(c.at(key)[0]), number(c.at(key)[1])); };
    const double gap = number(c.at("gap"));
    const double height = gap * number(c.at("blocker_fraction_of_gap_from_R1"));
    const auto down = [](const Vec2d& x, const Vec2d& z, double y) {
      return rectangle({x.x, y, z.x}, {x.y - x.x, 0, 0}, {0, 0, z.y - z.x});
    };
    Scene scene;
    add_mesh(scene, down(range("R2x"), range("R2y"), gap), glow(Rgb(1)));
    add_mesh(scene, down(range("blocker_x"), range("blocker_y"), height), matt(Rgb(0)));
    const LightSampler lights(scene);
    const PolygonShadows shadows(scene, lights, true, true);
    ASSERT_TRUE(shadows.has(0));
    const Vec2d x = range("R1x"), z = range("R1y");
    constexpr int n = 128;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) {
        const Vec3d p(x.x + (x.y - x.x) * (i + 0.5) / n, 0, z.x + (z.y - z.x) * (k + 0.5) / n);
        const auto factor = shadows.visible_factor(0, {p, 1e-9, {0, 1, 0}, {0, 1, 0}});
        ASSERT_TRUE(factor);
        sum += *factor / (n * n);
      }
    }
    // The mean is taken by midpoints, which blur what changes within one of their cells.
    EXPECT_NEAR(sum, number(c.at("F_obstructed")), height < 0.1 * gap ? 1e-4 : 1e-5) << c.at("name");
  }
}

/// A room full of what stands in the way.
Scene furnished() {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt({0.6F, 0.5F, 0.4F}));
  add_mesh(scene, box({-0.5, 0, -0.2}, {-0.1, 0.6, 0.2}), matt(Rgb(0.5F)));
  add_mesh(scene, box({0.2, 0.3, -0.4}, {0.6, 0.5, 0.3}), matt(Rgb(0.5F)));
  add_mesh(scene, rectangle({-0.4, 2, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}), glow({6, 5, 4}));
  add_mesh(scene, rectangle({1.5, 0.2, -0.3}, {0, 0, 0.6}, {0, 1, 0}), glow({1, 2, 3}));
  return scene;
}

TEST(ExactShadows, AreWhatManyRaysFind) {
  const Scene scene = furnished();
  const RayTracer tracer(scene);
  Dice dice(5);
  int partly = 0;
  for (const IntegratorKind kind : {IntegratorKind::appel, IntegratorKind::whitted}) {
    for (int n = 0; n < 30; ++n) {
      const Vec3d target(dice.between(-1, 1), 0, dice.between(-0.6, 0.6));
      const Vec3d eye(target.x + dice.between(-0.02, 0.02), 0.02, target.z + 0.03);
      const Seen clipped = look(tracer, eye, target - eye, exact(kind));
      EXPECT_EQ(clipped.rays.shadow, 0U);
      const Seen sampled = look(tracer, eye, target - eye, whitted(1024));
      EXPECT_NEAR(clipped.value, sampled.value, 4 * sampled.error + 1e-5);
      partly += sampled.error > 0 && clipped.value < 0.9 * sampled.value + 1 ? 1 : 0;
    }
  }
  EXPECT_GT(partly, 10);
}

// Gloss on top keeps its rays, and the mean.
TEST(ExactShadows, GlossIsLeftToRays) {
  Scene scene = furnished();
  Material polished = scene.materials[0];
  polished.specular = 1;
  polished.roughness = 0.4F;
  scene.materials[0] = polished;
  const RayTracer tracer(scene);
  for (const double x : {-0.8, 0.0, 0.4, 0.8}) {
    RenderOptions options = exact();
    options.samples_per_pixel = 4096;
    const Seen clipped = look(tracer, {x + 0.1, 0.1, 0.05}, {-0.1, -0.1, 0.02}, options);
    const Seen sampled = look(tracer, {x + 0.1, 0.1, 0.05}, {-0.1, -0.1, 0.02}, whitted(4096));
    EXPECT_NEAR(clipped.value, sampled.value, 4 * std::hypot(clipped.error, sampled.error));
    EXPECT_LT(clipped.error, sampled.error);
    EXPECT_GT(clipped.rays.shadow, 0U);
  }
}

// Behind balls, glass and holes the lamp is met by rays.
TEST(ExactShadows, WhatIsNoPolygonIsLeftToRays) {
  Scene scene;
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  add_mesh(scene, rectangle({-0.4, 2, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}), glow(Rgb(5)));
  add_shape(scene, Sphere{{0, 1, 0}, 0.3}, matt(Rgb(0)));
  const RayTracer tracer(scene);
  RenderOptions options = exact();
  options.samples_per_pixel = 4096;
  const Seen clipped = look(tracer, {0.5, 0.1, 0}, {-0.1, -0.1, 0}, options);
  const Seen sampled = look(tracer, {0.5, 0.1, 0}, {-0.1, -0.1, 0}, whitted(4096));
  EXPECT_GT(clipped.rays.shadow, 0U);
  EXPECT_NEAR(clipped.value, sampled.value, 4 * std::hypot(clipped.error, sampled.error));
  EXPECT_EQ(look(tracer, {5, 0.1, 0}, {-0.1, -0.1, 0}, options).rays.shadow, 0U);
}

}  // namespace
}  // namespace penumbra
