#include "penumbra/radiosity/pipeline/refining_shooting.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/radiosity/solvers/gauss_seidel.h"
#include "penumbra/scene/builtin_scenes.h"
#include "radiosity/shadow_floor.h"

namespace penumbra {
namespace {

constexpr double panel_reflectance = 0.8;
constexpr double spot_height = 1.5, spot_intensity = 10;

/// A floor that reflects nothing, a blocker, and above them a white panel that a spot lights from below: all light on
/// the floor comes from the panel.
Scene lit_panel() {
  Scene scene = polygon_scene({floor_rectangle(-1, 1, -1, 1)});
  scene.materials[0] = matt(0);
  scene.materials.push_back(matt(panel_reflectance));
  add_polygons(scene, "panel", {reversed(floor_rectangle(-0.25, 0.25, -0.25, 0.25, 2))}, 1);
  add_polygons(scene, "blocker", {floor_rectangle(-0.2, 0.2, -0.2, 0.2, 0.5)});
  scene.lights.push_back({"spot", SpotLight{.position = {0, 0, spot_height},
                                            .direction = {0, 0, 1},
                                            .intensity = Rgb(static_cast<float>(spot_intensity)),
                                            .inner_angle = 1.2,
                                            .outer_angle = 1.3}});
  return scene;
}

/// What a floor point sees of the panel between x0, x1, y0, y1, the blocker's shadow on it left out.
double seen_part(const Vec3d& p, double x0, double x1, double y0, double y1) {
  const auto hidden = [](double c, double from, double to) {
    return std::array{std::clamp(c + 4 * (-0.2 - c), from, to), std::clamp(c + 4 * (0.2 - c), from, to)};
  };
  const auto [hx0, hx1] = hidden(p.x, x0, x1);
  const auto [hy0, hy1] = hidden(p.y, y0, y1);
  using shadow_floor::from_part;
  if (!(hx1 > hx0 && hy1 > hy0)) return from_part(p, x0, x1, y0, y1);
  return from_part(p, x0, hx0, y0, y1) + from_part(p, hx1, x1, y0, y1) + from_part(p, hx0, hx1, y0, hy0) +
         from_part(p, hx0, hx1, hy1, y1);
}

/// Irradiance of a floor point: the panel in 12 x 12 pieces, each as bright as its middle.
double irradiance_below(const Vec3d& p) {
  constexpr int n = 12;
  double sum = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double x = -0.25 + 0.5 * i / n, y = -0.25 + 0.5 * j / n, step = 0.5 / n;
      const Vec3d way(x + step / 2, y + step / 2, 2 - spot_height);
      const double radiosity = panel_reflectance * spot_intensity * way.z / std::pow(length(way), 3);
      sum += radiosity * seen_part(p, x, x + step, y, y + step);
    }
  }
  return sum;
}

/// Root mean square over 50 x 50 floor points of what irradiance blended from the elements misses, over its mean.
double floor_error(const PatchMesh& elements, const std::vector<double>& irradiance) {
  std::vector<double> of_floor;
  for (std::size_t e = 0; e < elements.patch_count(); ++e) {
    if (elements.surfaces[e].face == 0 && !elements.surfaces[e].back) of_floor.push_back(irradiance[3 * e]);
  }
  const ShadingMesh shading = make_shading_mesh(shadow_floor::floor_of(elements));
  const std::vector<double> values = shading.at_vertices(of_floor, 1);
  double square = 0, mean = 0;
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 50; ++x) {
      const Vec3d p(-1 + 0.04 * (x + 0.37), -1 + 0.04 * (y + 0.61), 0);
      const double exact = irradiance_below(p);
      square += std::pow(shadow_floor::interpolate(shading, values, p) - exact, 2);
      mean += exact;
    }
  }
  return std::sqrt(square / 2500) / (mean / 2500);
}

RefiningShootingOptions with_elements(std::size_t count, double tolerance = 1e-3) {
  RefiningShootingOptions options;
  options.element_count = count;
  options.factors.tolerance = tolerance;
  return options;
}

TEST(RefiningShooting, ABrightPanelThatNoLampIsCastsRefinedShadows) {
  const Scene scene = lit_panel();
  constexpr std::size_t count = 3000;
  RefiningShooting shooting(scene, with_elements(count));
  const RadiositySolution refined = shooting.solve({});
  EXPECT_LE(shooting.mesh().surface_count(), count);

  RadiositySetupOptions even;
  even.element_count = count;
  even.solver = "shooting";
  even.factors.tolerance = 1e-3;
  const auto uniform = make_radiosity_setup(scene, even);
  const RadiositySolution plain = solve(*uniform, {}).solution;
  const double error = floor_error(shooting.mesh(), refined.irradiance);
  const double error_of_uniform = floor_error(uniform->mesh, plain.irradiance);
  EXPECT_LT(error, 0.7 * error_of_uniform) << error_of_uniform;
}

TEST(RefiningShooting, AgreesWithGaussSeidelOnItsFinalMesh) {
  const Scene scene = make_builtin_scene("cornell-box");
  RefiningShooting shooting(scene, with_elements(600));
  const RadiositySolution shot = shooting.solve({});
  SolverOptions exact;
  exact.tolerance = 1e-6;
  exact.stop_at = 1;
  const auto method = make_form_factor_method("auto", shooting.mesh());
  const FactorMatrix factors = assemble_factor_matrix(*method, shooting.mesh());
  const RadiositySolution gathered = solve_gauss_seidel(shooting.problem(), factors, exact);
  double square = 0, mean = 0, area = 0;
  for (std::size_t k = 0; k < shot.radiosity.size(); ++k) {
    const double a = shooting.problem().areas[k / 3];
    square += a * std::pow(shot.radiosity[k] - gathered.radiosity[k], 2);
    mean += a * gathered.radiosity[k];
    area += a;
  }
  // Elements gather once from each other; without that patches' means are off by 3 %.
  EXPECT_LT(std::sqrt(square / area), 0.01 * mean / area);
  EXPECT_NEAR(power_of(shooting.problem(), shot.radiosity), power_of(shooting.problem(), gathered.radiosity),
              1e-3 * mean);
}

/// All of what patches still have to send, W, signs aside.
double unshot_power(const PatchMesh& mesh, const std::vector<double>& unshot) {
  double power = 0;
  for (std::size_t k = 0; k < unshot.size(); ++k) power += mesh.surfaces[k / 3].area * std::abs(unshot[k]);
  return power;
}

void expect_falling_unshot_energy(const Scene& scene, std::size_t count) {
  RefiningShooting shooting(scene, with_elements(count));
  SolverOptions options;
  double last = 1e300;
  std::size_t elements = 0, cuts = 0;
  options.on_stage = [&](const SolverStage& stage) {
    const double unshot = unshot_power(shooting.mesh(), stage.unshot);
    EXPECT_LT(unshot, last);
    last = unshot;
    if (shooting.mesh().surface_count() != elements) ++cuts;
    elements = shooting.mesh().surface_count();
    EXPECT_EQ(stage.radiosity.size(), 3 * elements);
  };
  const RadiositySolution solution = shooting.solve(options);
  EXPECT_TRUE(solution.converged);
  EXPECT_GE(cuts, 2U);
  EXPECT_LE(elements, count);
  const EnergyBalance& e = solution.energy;
  EXPECT_NEAR(e.emitted, e.absorbed + e.escaped + e.unshot, 1e-9 * e.emitted);
}

TEST(RefiningShooting, UnshotEnergyFallsAndAllEnergyIsKept) {
  expect_falling_unshot_energy(make_builtin_scene("cornell-box"), 800);
}

// Where colours and the light of lamps without a body vary within an element its pieces reflect more or less than it
// did: the energy must fall all the same.
TEST(RefiningShooting, UnshotEnergyFallsOnAPattern) {
  Scene scene = lit_panel();
  scene.materials[0] = matt(0.9);
  scene.materials[0].checker_colour = Rgb(0.1F);
  expect_falling_unshot_energy(scene, 800);
}

TEST(RefiningShootingThreaded, GivesTheSameBitsOnAnyThreadCount) {
  const Scene scene = lit_panel();
  std::vector<double> radiosity;
  std::vector<Vec3d> corners;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    RefiningShooting shooting(scene, with_elements(400));
    const RadiositySolution solution = shooting.solve({});
    if (radiosity.empty()) {
      radiosity = solution.radiosity;
      corners = shooting.mesh().corner_positions;
    }
    EXPECT_EQ(solution.radiosity, radiosity) << threads;
    EXPECT_EQ(shooting.mesh().corner_positions, corners) << threads;
  }
}

TEST(RefiningShooting, BacksAreBlackWhenTheyAreAskedToBe) {
  const Scene scene = make_builtin_scene("cornell-box");
  RadiositySetupOptions options;
  options.subdivision = Subdivision::adaptive;
  options.solver = "shooting";
  options.element_count = 300;
  options.front_sides_only = true;
  const auto setup = make_radiosity_setup(scene, options);
  ASSERT_TRUE(setup->refining);
  const SceneRadiosity solved = solve(*setup, {});
  ASSERT_EQ(solved.solution.radiosity.size(), 3 * setup->mesh.surface_count());
  for (std::size_t e = 0; e < setup->mesh.surface_count(); ++e) {
    if (!setup->mesh.surfaces[e].back) continue;
    EXPECT_EQ(solved.solution.radiosity[3 * e], 0);
  }
}

}  // namespace
}  // namespace penumbra
