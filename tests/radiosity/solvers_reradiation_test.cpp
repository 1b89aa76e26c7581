#include "penumbra/radiosity/solvers/reradiation.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "penumbra/radiosity/solvers/solver.h"
#include "test_paths.h"

namespace penumbra {
namespace {

nlohmann::json fluorescence() {
  return nlohmann::json::parse(std::ifstream(PENUMBRA_TEST_DATA "/optics_spectrum.json"))["fluorescence"];
}

/// A closed sphere cut into n equal pieces: every factor is 1 / n (the sphere's own law).
FactorMatrix sphere_factors(std::size_t n) {
  FactorMatrix factors;
  factors.areas.assign(n, 1.0);
  factors.offsets = {0};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      factors.columns.push_back(static_cast<std::uint32_t>(j));
      factors.values.push_back(1.0 / static_cast<double>(n));
    }
    factors.offsets.push_back(factors.columns.size());
  }
  return factors;
}

struct Furnace {
  RadiosityProblem problem;
  Reradiation reradiation;
};

/// n elements of one dye. @param matrix ascending bands, [out][in]. @param emission W/m^2, of each band.
Furnace furnace(std::size_t n, const std::vector<std::vector<double>>& matrix, const std::vector<double>& emission) {
  Furnace made;
  const std::size_t bands = matrix.size();
  made.problem.bands = bands;
  made.problem.areas.assign(n, 0.5);
  made.reradiation.matrices.emplace_back();
  for (const auto& row : matrix) {
    for (const double share : row) made.reradiation.matrices[0].push_back(share);
  }
  made.reradiation.matrix_of.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t b = 0; b < bands; ++b) {
      made.problem.reflectance.push_back(matrix[b][b]);
      made.problem.emission.push_back(emission[b]);
    }
  }
  return made;
}

const SolverOptions exact{
    .tolerance = 1e-12, .most_unshot = 1e-12, .stop_at = 1, .max_iterations = 0, .progress = {}, .on_stage = {}};

TEST(Reradiation, TwoBandFurnaceByEverySolver) {
  const auto table = fluorescence()["furnace_two_band"];  // visible first: turned round
  const auto d = [&](int out, int in) { return table["D"][out][in].get<double>(); };
  const Furnace f = furnace(12, {{d(1, 1), d(1, 0)}, {d(0, 1), d(0, 0)}},
                            {table["E_uv_only"][1].get<double>(), table["E_uv_only"][0].get<double>()});
  for (const std::string_view solver : solver_names()) {
    const auto s = solve_with_reradiation(solver, f.problem, f.reradiation, sphere_factors(12), exact);
    for (std::size_t i = 0; i < 12; ++i) {
      EXPECT_NEAR(s.radiosity[2 * i], table["B"][1].get<double>(), 1e-9) << solver;
      EXPECT_NEAR(s.radiosity[2 * i + 1], table["B"][0].get<double>(), 1e-9) << solver;
    }
    EXPECT_NEAR(s.energy.emitted, 6, 1e-12) << "what dye radiates again is no emission";
    EXPECT_NEAR(s.energy.absorbed, s.energy.emitted, 1e-8);
  }
}

TEST(Reradiation, SixBandFurnaceByEverySolver) {
  const auto table = fluorescence()["furnace_six_band"];
  const Furnace f =
      furnace(10, table["D"].get<std::vector<std::vector<double>>>(), table["E"].get<std::vector<double>>());
  for (const std::string_view solver : solver_names()) {
    const auto s = solve_with_reradiation(solver, f.problem, f.reradiation, sphere_factors(10), exact);
    for (std::size_t k = 0; k < s.radiosity.size(); ++k) {
      EXPECT_NEAR(s.radiosity[k], table["B"][k % 6].get<double>(), 1e-9) << solver;
    }
    EXPECT_NEAR(s.energy.absorbed, s.energy.emitted, 1e-8);
    EXPECT_TRUE(s.converged);
  }
}

// A closed sphere of radius R under a point source at its middle: beta = (I - D)^-1 D phi / (4 pi R^2).
TEST(Reradiation, SphereOfDyeAroundAnUltravioletPoint) {
  constexpr double radius = 1.7, flux = 30;
  constexpr std::size_t n = 16;
  Furnace f = furnace(n, {{0.6, 0}, {0.3, 0.5}}, {0, 0});
  const double area = 4 * std::numbers::pi * radius * radius;
  f.problem.areas.assign(n, area / n);
  for (std::size_t i = 0; i < n; ++i) f.problem.irradiance.insert(f.problem.irradiance.end(), {flux / area, 0});
  f.problem.light_power = {flux, 0};
  const auto s = solve_with_reradiation("gauss-seidel", f.problem, f.reradiation, sphere_factors(n), exact);
  // (I - D)^-1 D e_uv, by hand: uv 0.6 / 0.4 = 1.5; visible (0.3 + 0.3 * 1.5) / 0.5 = 1.5.
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_NEAR(s.radiosity[2 * i], 1.5 * flux / area, 1e-9);
    EXPECT_NEAR(s.radiosity[2 * i + 1], 1.5 * flux / area, 1e-9);
  }
  EXPECT_NEAR(s.energy.emitted, flux, 1e-9);
  EXPECT_NEAR(s.energy.absorbed, flux, 1e-7);
}

// Light of the longest band excites nothing: all shorter ones stay exactly dark.
TEST(Reradiation, NothingGoesToShorterWavelengths) {
  const Furnace f = furnace(8, {{0.5, 0, 0}, {0.2, 0.5, 0}, {0.1, 0.3, 0.5}}, {0, 0, 1});
  const auto s = solve_with_reradiation("gauss-seidel", f.problem, f.reradiation, sphere_factors(8), exact);
  for (std::size_t k = 0; k < s.radiosity.size(); ++k) {
    EXPECT_NEAR(s.radiosity[k], k % 3 == 2 ? 2 : 0, k % 3 == 2 ? 1e-9 : 0);
  }
}

TEST(Reradiation, WithoutDyeItIsTheOrdinarySolution) {
  Furnace f = furnace(9, {{0.3, 0, 0}, {0, 0.6, 0}, {0, 0, 0.8}}, {1, 2, 3});
  f.reradiation = {};
  const auto apart = solve_with_reradiation("gauss-seidel", f.problem, f.reradiation, sphere_factors(9), exact);
  const auto joint = solve_radiosity("gauss-seidel", f.problem, sphere_factors(9), exact);
  for (std::size_t k = 0; k < joint.radiosity.size(); ++k) EXPECT_NEAR(apart.radiosity[k], joint.radiosity[k], 1e-9);
}

TEST(Reradiation, WrongMatricesAreRefused) {
  const auto refused = [](std::vector<std::vector<double>> matrix) {
    const Furnace f = furnace(4, matrix, {1, 1});
    EXPECT_THROW((void)solve_with_reradiation("direct", f.problem, f.reradiation, sphere_factors(4)),
                 std::invalid_argument);
  };
  refused({{0.1, 0.01}, {0, 0.1}});  // radiates at shorter wavelengths
  refused({{0.6, 0}, {0.5, 0.1}});   // 1.1 times what arrives
  refused({{0.1, 0}, {-0.1, 0.1}});
}

}  // namespace
}  // namespace penumbra
