// Radiosity through air that absorbs.

#include "penumbra/radiosity/absorbing_air.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/radiosity/pipeline/weakened_factors.h"
#include "penumbra/radiosity/solvers/solver.h"
#include "penumbra/scene/builtin_scenes.h"
#include "radiosity/enclosure_table.h"
#include "radiosity/enclosures.h"
#include "radiosity/round_cavities.h"

namespace penumbra {
namespace {

using test::convex_factors;
using test::element_mesh;
using test::enclosure_table;
using test::sphere_facets;
using test::uniform_problem;

constexpr double pi = std::numbers::pi;

/// Nothing but air that absorbs.
Scene air_of(double kappa) {
  Scene scene;
  scene.media.push_back({.name = "air", .absorption = Rgb(static_cast<float>(kappa))});
  scene.air = {0};
  return scene;
}

SolverOptions strict() {
  SolverOptions options;
  options.tolerance = 1e-13;
  options.stop_at = 1;
  return options;
}

// Facets approach the sphere, and their middles its chords, with the square of their size: two meshes tell the limit.
void expect_filled_sphere(int coarse, int fine, double tolerance) {
  struct Cavity {
    PatchMesh mesh;
    FactorMatrix factors;
  };
  std::vector<Cavity> cavities;
  for (const int n : {coarse, fine}) {
    Cavity c{element_mesh(sphere_facets(1, 0, pi, n, 2 * n)), {}};
    c.factors = convex_factors(c.mesh);
    cavities.push_back(std::move(c));
  }
  for (const auto& c : enclosure_table()["sphere_filled_with_absorber"]["cases"]) {
    const Scene scene = air_of(c["kappaR"]);
    const AbsorbingAir air(scene);
    std::vector<double> found;
    for (const Cavity& cavity : cavities) {
      FactorMatrix factors = cavity.factors;
      const auto taken = weaken_factors(cavity.mesh, air, factors);
      const auto solution =
          solve_radiosity("gauss-seidel", uniform_problem(factors.areas, 1, c["rho"], 1), factors, strict());
      double sum = 0, area = 0;
      for (std::size_t i = 0; i < factors.rows(); ++i) {
        sum += factors.areas[i] * solution.radiosity[i];
        area += factors.areas[i];
        EXPECT_NEAR(taken[i], 1 - c["T"].get<double>(), 0.05);
      }
      found.push_back(sum / area);
    }
    const double b = c["B"];
    EXPECT_LT(std::abs(found[1] - b), 0.35 * std::abs(found[0] - b) + 1e-6) << c;
    EXPECT_NEAR((4 * found[1] - found[0]) / 3, b, tolerance * b) << c << " " << found[0] << " " << found[1];
  }
}

TEST(AbsorbingAir, SphereFilledWithAbsorber) { expect_filled_sphere(5, 10, 1.5e-3); }

TEST(AbsorbingAir, SlowSphereFilledWithAbsorber) { expect_filled_sphere(9, 18, 1e-4); }

// A small patch under a plate so wide that the rest is dark: the share of its light that crosses is 2 E3(t).
TEST(AbsorbingAir, AbsorbingSlabBetweenPlates) {
  std::vector<Polygon> polygons{floor_rectangle(-0.01, 0.01, -0.01, 0.01)};
  constexpr int around = 24;
  std::vector<double> radii{0};
  while (radii.back() < 500) radii.push_back(radii.back() < 2 ? radii.back() + 0.1 : 1.08 * radii.back());
  const auto at = [](double r, int k) {
    return Vec3d(r * std::cos(2 * pi * k / around), r * std::sin(2 * pi * k / around), 1);
  };
  for (std::size_t i = 0; i + 1 < radii.size(); ++i) {
    for (int k = 0; k < around; ++k) {
      Polygon cell{at(radii[i], k), at(radii[i], k + 1), at(radii[i + 1], k + 1), at(radii[i + 1], k)};
      if (i == 0) cell.erase(cell.begin());
      polygons.push_back(std::move(cell));
    }
  }
  const PatchMesh mesh = element_mesh(polygons);
  ExchangeAreaScratch scratch;
  for (const auto& c : enclosure_table()["absorbing_slab_between_plates"]["cases"]) {
    const Scene scene = air_of(c["t"]);
    const AbsorbingAir air(scene);
    double crossing = 0;
    for (std::size_t j = 1; j < mesh.patch_count(); ++j) {
      crossing += exchange_area(mesh.polygon(0), mesh.polygon(j), scratch) / mesh.areas[0] *
                  air.between(mesh.polygon(0), mesh.polygon(j));
    }
    const double t = c["T"];
    EXPECT_NEAR(crossing, t, 2e-4 * t) << c;
    // Two plates that see nothing but each other through it.
    RadiosityProblem problem = uniform_problem({1, 1}, 1, c["rho"], 0);
    problem.emission = {c["E1"], c["E2"]};
    const auto b = solve_radiosity("jacobi", problem, test::sparse({1, 1}, {{0, crossing}, {crossing, 0}}), strict());
    EXPECT_NEAR(b.radiosity[0], c["B1"].get<double>(), 1e-4);
    EXPECT_NEAR(b.radiosity[1], c["B2"].get<double>(), 1e-4);
  }
}

// What the air takes is counted, and the light of the scene falls.
TEST(AbsorbingAir, EnergyOfARoomIsCounted) {
  Scene scene = make_builtin_scene("furnace");
  RadiositySetupOptions options;
  options.element_count = 300;
  const auto clear = make_radiosity_setup(scene, options);
  const SceneRadiosity open = solve(*clear, strict());
  scene.media.push_back({.name = "air", .absorption = Rgb(0.3F)});
  scene.air = {0};
  const auto setup = make_radiosity_setup(scene, options);
  const SceneRadiosity dim = solve(*setup, strict());
  const EnergyBalance& e = dim.solution.energy;
  EXPECT_GT(dim.absorbed_by_air, 0.05 * e.emitted);
  EXPECT_NEAR(e.absorbed + e.escaped + dim.absorbed_by_air, e.emitted, 1e-3 * e.emitted);
  EXPECT_NEAR(e.escaped, 0, 5e-3 * e.emitted);
  for (std::size_t i = 0; i < dim.solution.radiosity.size(); ++i) {
    EXPECT_LE(dim.solution.radiosity[i], open.solution.radiosity[i]);
  }
}

TEST(AbsorbingAir, WhatRadiosityDoesNotKnowIsRefused) {
  Scene fog = air_of(1);
  fog.media[0].scattering = Rgb(0.1F);
  EXPECT_THROW(AbsorbingAir{fog}, std::invalid_argument);
  Scene coloured = air_of(1);
  coloured.media[0].absorption.x = 2;
  EXPECT_THROW(AbsorbingAir{coloured}, std::invalid_argument);
  Scene filled = air_of(1);
  filled.materials.emplace_back().medium = 0;
  EXPECT_THROW(AbsorbingAir{filled}, std::invalid_argument);
  EXPECT_TRUE(AbsorbingAir(Scene{}).is_clear());
}

}  // namespace
}  // namespace penumbra
