#include "penumbra/baking/probes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "baking/quad_atlas.h"
#include "penumbra/baking/directional_texels.h"
#include "penumbra/baking/spherical_harmonics.h"
#include "penumbra/baking/texel_openness.h"
#include "penumbra/math/quadrature.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using test::Quad;

Quad floor_quad(double x0, double x1, double z0, double z1, double y = 0) {
  return {{Vec3d(x0, y, z0), {x0, y, z1}, {x1, y, z1}, {x1, y, z0}}};
}

struct Solved {
  LightmapAtlas atlas;
  Texels texels;
  std::unique_ptr<TexelSolution> solution;
};

std::unique_ptr<Solved> solved(Scene scene, const std::vector<Quad>& quads) {
  auto s = std::make_unique<Solved>();
  s->atlas = test::quad_atlas(std::move(scene), quads);
  s->texels = make_texels(s->atlas);
  s->solution = std::make_unique<TexelSolution>(s->atlas, s->texels, TexelSolution::Options{}, Progress{});
  return s;
}

TEST(SphericalHarmonics, AreOrthonormal) {
  std::array<std::array<double, 9>, 9> products{};
  constexpr int rings = 8, around = 16;
  for (const GaussNode& node : gauss_legendre(rings)) {
    const double z = 2 * node.x - 1, r = std::sqrt(1 - z * z);
    for (int k = 0; k < around; ++k) {
      const double phi = 2 * pi * k / around;
      const auto y = spherical_harmonics({r * std::cos(phi), r * std::sin(phi), z});
      for (std::size_t i = 0; i < 9; ++i) {
        for (std::size_t j = 0; j < 9; ++j) products[i][j] += 4 * pi * node.weight / around * y[i] * y[j];
      }
    }
  }
  for (std::size_t i = 0; i < 9; ++i) {
    for (std::size_t j = 0; j < 9; ++j) EXPECT_NEAR(products[i][j], i == j ? 1 : 0, 1e-12) << i << j;
  }
}

TEST(SphericalHarmonics, IrradianceOfASkyThatGrowsWithHeight) {
  // Radiance 1 + a y: irradiance pi + 2 pi a n.y / 3.
  std::array<Rgb, 9> sky{};
  sky[0] = Rgb(static_cast<float>(std::sqrt(4 * pi)));
  sky[1] = Rgb(static_cast<float>(0.5 * std::sqrt(4 * pi / 3)));
  for (const Vec3d& n : {Vec3d(0, 1, 0), Vec3d(0, -1, 0), Vec3d(0.6, 0, 0.8), normalize(Vec3d(1, 2, 3))}) {
    EXPECT_NEAR(irradiance_from(sky, n).x, pi + pi / 3 * n.y, 1e-5);
  }
}

TEST(Probes, EvenSkyIsExact) {
  Scene scene;
  scene.materials = {matt(0)};
  scene.environment.emplace().radiance = Rgb(0.5F, 1.0F, 2.0F);
  // A speck far below hides next to nothing.
  const auto s = solved(scene, {floor_quad(-1e-4, 1e-4, -1e-4, 1e-4, -10)});
  ProbeOptions options;
  options.bounds.grow(Vec3d(-1));
  options.bounds.grow(Vec3d(1));
  options.count = {2, 1, 3};
  const ProbeGrid grid = bake_probes(*s->solution, options);
  ASSERT_EQ(grid.positions.size(), 6U);
  EXPECT_EQ(grid.positions[0], Vec3d(-1, 0, -1));
  EXPECT_EQ(grid.positions[5], Vec3d(1, 0, 1));
  for (std::size_t p = 0; p < 6; ++p) {
    const auto sky = grid.radiance(p);
    EXPECT_NEAR(sky[0].x, 0.5 * std::sqrt(4 * pi), 1e-5);
    EXPECT_NEAR(sky[0].z, 2 * std::sqrt(4 * pi), 1e-4);
    for (std::size_t k = 1; k < 9; ++k) EXPECT_NEAR(sky[k].y, 0, 1e-5) << k;
    EXPECT_NEAR(irradiance_from(sky, {0, 0, 1}).y, pi, 1e-5);
  }
}

TEST(Probes, APointLightIsItsHarmonics) {
  Scene scene;
  scene.materials = {matt(0)};
  scene.lights.push_back({.name = "point", .kind = PointLight{.position = {0, 2, 0}, .intensity = Rgb(3)}});
  const auto s = solved(scene, {floor_quad(-1, 1, -1, 1, -1)});
  ProbeOptions options;
  options.bounds.grow(Vec3d(0));
  options.count = {1, 1, 1};
  const auto sky = bake_probes(*s->solution, options).radiance(0);
  const auto y = spherical_harmonics({0, 1, 0});
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(sky[k].x, 3.0 / 4 * y[k], 1e-6);
}

TEST(Probes, InAFurnaceAllDirectionsAreAlike) {
  // A closed box that emits E and reflects rho: radiance E / (pi (1 - rho)) from everywhere.
  std::vector<Quad> quads;
  const double size = 2;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool high : {false, true}) {
      Vec3d a(0), b(0), corner(0);
      a[(axis + 1) % 3] = size, b[(axis + 2) % 3] = size;
      corner[axis] = high ? size : 0;
      if (high) std::swap(a, b);
      quads.push_back({{corner, corner + a, corner + a + b, corner + b}});
    }
  }
  Scene scene;
  scene.materials = {matt(0.5, 1 / pi)};
  const auto s = solved(scene, quads);
  ProbeOptions options;
  options.count = {2, 2, 2};
  const ProbeGrid grid = bake_probes(*s->solution, options);
  for (std::size_t p = 0; p < grid.positions.size(); ++p) {
    EXPECT_EQ(grid.is_inside[p], 0);
    const auto sky = grid.radiance(p);
    EXPECT_NEAR(sky[0].x / (2 / pi * std::sqrt(4 * pi)), 1, 0.02);
    for (std::size_t k = 1; k < 9; ++k) EXPECT_NEAR(sky[k].x, 0, 0.04 * sky[0].x) << k;
  }
}

TEST(Openness, FloorBesideAWall) {
  // Of what the floor sees a wall of height h hides its form factor.
  std::vector<Quad> quads{floor_quad(0, 1, -0.5, 0.5), {{Vec3d(0, 0, 3), {0, 0, -3}, {0, 2, -3}, {0, 2, 3}}}};
  Scene scene;
  scene.materials = {matt(0.5)};
  const LightmapAtlas atlas = test::quad_atlas(scene, quads);
  const Texels texels = make_texels(atlas);
  const std::vector<float> open = openness_of_texels(atlas, texels, {.rays = 1024}).open;
  double squares = 0, count = 0;
  for (std::size_t t = 0; t < texels.count(); ++t) {
    if (atlas.chart_of_triangle[texels.triangles[t]] != 0) continue;
    const double hidden = point_to_polygon(texels.positions[t], {0, 1, 0}, quads[1].corners);
    squares += std::pow(open[t] - (1 - hidden), 2), count += 1;
  }
  EXPECT_LT(std::sqrt(squares / count), 0.003);
  // What is farther than the distance does not hide.
  const std::vector<float> near = openness_of_texels(atlas, texels, {.distance = 0.3}).open;
  for (std::size_t t = 0; t < texels.count(); ++t) {
    const bool is_far = atlas.chart_of_triangle[texels.triangles[t]] == 0 && texels.positions[t].x > 0.3;
    if (is_far) {
      EXPECT_EQ(near[t], 1);
    }
  }
}

TEST(DirectionalTexels, HalfASky) {
  // Radiance 1 from above only: the integral of each harmonic over the upper hemisphere.
  Scene scene;
  scene.materials = {matt(0)};
  scene.environment.emplace().radiance = Rgb(1.0F);
  const auto s = solved(scene, {floor_quad(0, 1, 0, 1)});
  const DirectionalTexels light = bake_directional_texels(*s->solution, {.rays = 1024});
  for (std::size_t t = 0; t < s->texels.count(); ++t) {
    const float* c = &light.coefficients[12 * t];
    EXPECT_NEAR(c[0], 2 * pi * std::sqrt(1 / (4 * pi)), 1e-4);
    EXPECT_NEAR(c[3], pi * std::sqrt(3 / (4 * pi)), 2e-2);  // y
    EXPECT_NEAR(c[6], 0, 2e-2);
    EXPECT_NEAR(c[9], 0, 2e-2);
  }
}

TEST(DirectionalTexels, ALampIsWhereItIs) {
  // A small lamp far away: its irradiance at the floor, times the harmonics of its direction, over its cosine.
  Scene scene;
  scene.materials = {matt(0), matt(0, 100)};
  const auto s = solved(scene, {floor_quad(-0.1, 0.1, -0.1, 0.1),
                                {{Vec3d(2.95, 4, -0.05), {3.05, 4, -0.05}, {3.05, 4, 0.05}, {2.95, 4, 0.05}}, 1}});
  const DirectionalTexels light = bake_directional_texels(*s->solution, {});
  const double solid_angle = 0.01 * 0.8 / 25;
  const auto y = spherical_harmonics({0.6, 0.8, 0});
  for (std::size_t t = 0; t < s->texels.count(); ++t) {
    if (s->atlas.chart_of_triangle[s->texels.triangles[t]] != 0) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(light.coefficients[12 * t + 3 * k], 100 * solid_angle * y[k], 0.05 * 100 * solid_angle) << k;
    }
  }
}

}  // namespace
}  // namespace penumbra
