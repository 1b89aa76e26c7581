#include "penumbra/radiosity/solvers/heat_exchange.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include "radiosity/enclosure_table.h"
#include "radiosity/enclosures.h"

namespace penumbra {
namespace {

using test::enclosure_table;
using test::sparse;

HeatSurface at(double temperature, double emissivity) { return {"hot", emissivity, temperature, std::nullopt}; }
HeatSurface fed(double heat_flux, double emissivity) { return {"fed", emissivity, std::nullopt, heat_flux}; }

nlohmann::json textbook(const std::string& id) {
  for (const auto& c : enclosure_table()["engineering"]["cases"]) {
    if (c["id"] == id) return c;
  }
  ADD_FAILURE() << id;
  return {};
}

TEST(HeatExchange, InfiniteParallelPlates) {
  const auto c = textbook("infinite_parallel_plates");
  const auto heat = solve_heat_exchange({at(c["T1"], c["e1"]), at(c["T2"], c["e2"])}, sparse({1, 1}, {{0, 1}, {1, 0}}));
  EXPECT_NEAR(heat.heat_flux[0], c["q_W_m2"].get<double>(), 1e-6);
  EXPECT_NEAR(heat.heat_flux[1], -c["q_W_m2"].get<double>(), 1e-6);
  EXPECT_TRUE(heat.converged);
}

// The shield's two sides are insulated from the rest: what one takes the other gives. They are one temperature only if
// the heat that crosses is the same, which is found here from the middle: the flux that the textbook gives.
TEST(HeatExchange, ARadiationShieldFloatsBetweenThePlates) {
  const auto c = textbook("radiation_shield");
  const double q = c["q_W_m2"], shield = c["e_shield"];
  const FactorMatrix facing = sparse({1, 1}, {{0, 1}, {1, 0}});
  const auto upper = solve_heat_exchange({at(c["T1"], c["e1"]), fed(-q, shield)}, facing);
  const auto lower = solve_heat_exchange({fed(q, shield), at(c["T2"], c["e2"])}, facing);
  EXPECT_NEAR(upper.temperature[1], lower.temperature[0], 1e-6);
  EXPECT_NEAR(upper.heat_flux[0], q, 1e-6);
}

const FactorMatrix triangle = sparse({1, 1, 1}, {{0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}});

TEST(HeatExchange, TriangularFurnaceWithAnInsulatedSide) {
  const double q = textbook("triangular_furnace_insulated_side")["Q_per_m"];
  const auto heat = solve_heat_exchange({at(600, 0.7), at(1000, 1), fed(0, 0.8)}, triangle);
  EXPECT_NEAR(heat.heat[1], q, 1e-6 * q);
  EXPECT_NEAR(heat.heat[0], -q, 1e-6 * q);
  EXPECT_NEAR(heat.heat[2], 0, 1e-9 * q);
}

TEST(HeatExchange, PaintOven) {
  const auto c = textbook("paint_oven_triangular_duct");
  const double ratio = stefan_boltzmann / c["sigma"].get<double>();  // the book rounds the constant
  const auto heat = solve_heat_exchange({at(1200, 0.8), at(500, 0.4), fed(0, 0.8)}, triangle);
  const double q = c["Q_per_m"].get<double>() * ratio;
  EXPECT_NEAR(heat.heat[0], q, 1e-9 * q);
  EXPECT_NEAR(heat.radiosity[0], c["J1"].get<double>() * ratio, 1e-9 * heat.radiosity[0]);
  EXPECT_NEAR(heat.radiosity[1], c["J2"].get<double>() * ratio, 1e-9 * heat.radiosity[1]);
  EXPECT_NEAR(heat.temperature[2], c["T_reradiating"].get<double>(), 1e-6);
}

TEST(HeatExchange, CylindricalFurnace) {
  const auto c = textbook("cylindrical_furnace");
  const double f = c["F12"], disk = std::numbers::pi, side = 2 * std::numbers::pi, back = (1 - f) * disk / side;
  const FactorMatrix factors = sparse({disk, disk, side}, {{0, f, 1 - f}, {f, 0, 1 - f}, {back, back, 1 - 2 * back}});
  const auto heat = solve_heat_exchange({at(700, 0.8), at(500, 0.4), at(400, 1)}, factors);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(heat.heat[i], c["Q_W_exactF"][i].get<double>(), 1e-5);
  EXPECT_NEAR(heat.imbalance, 0, 1e-9 * heat.supplied);
}

TEST(HeatExchange, ConcentricCylindersAndSpheres) {
  for (const auto& [id, areas] :
       {std::pair("concentric_cylinders_diffuse", 0.5), {"concentric_spheres_diffuse", 0.25}}) {
    const auto c = textbook(id);
    const FactorMatrix factors = sparse({areas, 1}, {{0, 1}, {areas, 1 - areas}});
    const auto heat = solve_heat_exchange({at(c["T1"], c["e1"]), at(c["T2"], c["e2"])}, factors);
    EXPECT_NEAR(heat.heat_flux[0], c["q1_per_A1"].get<double>(), 1e-5) << id;
    EXPECT_NEAR(heat.imbalance, 0, 1e-9 * heat.supplied) << id;
  }
}

// Given the fluxes that came out, the temperatures that went in come back.
TEST(HeatExchange, TemperaturesAndFluxesAreInversesOfEachOther) {
  const FactorMatrix factors = test::convex_factors(test::element_mesh(Dice(4).convex_cavity(20)));
  Dice dice(5);
  std::vector<HeatSurface> hot;
  for (std::size_t i = 0; i < factors.rows(); ++i) hot.push_back(at(dice.between(200, 1500), dice.between(0.05, 1)));
  const auto first = solve_heat_exchange(hot, factors);
  EXPECT_NEAR(first.imbalance, 0, 1e-9 * first.supplied);
  std::vector<HeatSurface> mixed = hot;
  for (std::size_t i = 1; i < mixed.size(); ++i) mixed[i] = fed(first.heat_flux[i], hot[i].emissivity);
  const auto second = solve_heat_exchange(mixed, factors);
  for (std::size_t i = 0; i < hot.size(); ++i) {
    EXPECT_NEAR(second.temperature[i], *hot[i].temperature, 1e-6 * *hot[i].temperature);
    EXPECT_NEAR(second.heat_flux[i], first.heat_flux[i], 1e-8 * first.supplied);
  }
}

// Large systems are solved by sweeps.
TEST(HeatExchange, SweepsComeToTheSameAsElimination) {
  const FactorMatrix factors = test::convex_factors(test::element_mesh(Dice(4).convex_cavity(20)));
  std::vector<HeatSurface> surfaces;
  for (std::size_t i = 0; i < factors.rows(); ++i) {
    surfaces.push_back(i % 3 == 0 ? at(300 + 20 * static_cast<double>(i), 0.5) : fed(i % 3 == 1 ? 0 : -5, 0.7));
  }
  HeatExchangeOptions sweeps;
  sweeps.most_direct = 0;
  sweeps.tolerance = 1e-13;
  const auto swept = solve_heat_exchange(surfaces, factors, sweeps);
  const auto eliminated = solve_heat_exchange(surfaces, factors);
  EXPECT_TRUE(swept.converged);
  EXPECT_GT(swept.iterations, std::size_t{1});
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    EXPECT_NEAR(swept.temperature[i], eliminated.temperature[i], 1e-6);
    EXPECT_NEAR(swept.heat_flux[i], eliminated.heat_flux[i], 1e-6);
  }
}

// An isothermal enclosure exchanges nothing, also with surroundings of its own temperature.
TEST(HeatExchange, AtOneTemperatureNothingFlows) {
  FactorMatrix factors = test::convex_factors(test::element_mesh(Dice(6).convex_cavity(20)));
  for (double& f : factors.values) f *= 0.8;
  std::vector<HeatSurface> surfaces;
  for (std::size_t i = 0; i < factors.rows(); ++i) surfaces.push_back(at(300, 0.1 + 0.8 * static_cast<double>(i % 2)));
  HeatExchangeOptions options;
  options.surroundings_temperature = 300;
  const auto heat = solve_heat_exchange(surfaces, factors, options);
  for (const double q : heat.heat_flux) EXPECT_NEAR(q, 0, 1e-9);
  EXPECT_NEAR(heat.to_surroundings, 0, 1e-8);
}

// A plate alone in space: q = eps sigma T^4.
TEST(HeatExchange, ALonePlateRadiatesToSpace) {
  const FactorMatrix alone = sparse({2}, {{0}});
  const auto heat = solve_heat_exchange({at(400, 0.3)}, alone);
  EXPECT_NEAR(heat.heat[0], 2 * 0.3 * stefan_boltzmann * std::pow(400, 4), 1e-9);
  EXPECT_NEAR(heat.to_surroundings, heat.heat[0], 1e-9);
  const auto fed_plate = solve_heat_exchange({fed(heat.heat_flux[0], 0.3)}, alone);
  EXPECT_NEAR(fed_plate.temperature[0], 400, 1e-9);
}

TEST(HeatExchange, APerfectReflectorHasNoTemperatureOfItsOwn) {
  const auto heat = solve_heat_exchange({at(600, 0.7), at(1000, 1), fed(0, 0)}, triangle);
  EXPECT_TRUE(std::isnan(heat.temperature[2]));
  EXPECT_NEAR(heat.heat[0] + heat.heat[1], 0, 1e-8);
}

TEST(HeatExchange, RefusesWhatCannotBe) {
  EXPECT_THROW((void)solve_heat_exchange({at(1, 1)}, triangle), std::invalid_argument);
  EXPECT_THROW((void)solve_heat_exchange({at(600, 2), at(1, 1), at(1, 1)}, triangle), std::invalid_argument);
  EXPECT_THROW((void)solve_heat_exchange({at(-1, 1), at(1, 1), at(1, 1)}, triangle), std::invalid_argument);
  EXPECT_THROW((void)solve_heat_exchange({{"x", 1, {}, {}}, at(1, 1), at(1, 1)}, triangle), std::invalid_argument);
  EXPECT_THROW((void)solve_heat_exchange({fed(5, 0), at(1, 1), at(1, 1)}, triangle), std::invalid_argument);
  // Heat alone in a closed enclosure; more heat taken than arrives.
  EXPECT_THROW((void)solve_heat_exchange({fed(1, 1), fed(-1, 1), fed(0, 1)}, triangle), std::invalid_argument);
  EXPECT_THROW((void)solve_heat_exchange({fed(-1e6, 0.5), at(300, 1), at(300, 1)}, triangle), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
