#include "penumbra/radiosity/solvers/heat_exchange.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "penumbra/radiosity/solvers/gauss_seidel.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"

namespace penumbra {
namespace {

double fourth_power(double x) { return x * x * x * x; }

[[noreturn]] void refuse(const HeatSurface& surface, std::string_view sentence) {
  throw std::invalid_argument(fmt::format("surface {}: {}", surface.name, sentence));
}

void check(const HeatSurface& s) {
  if (!(s.emissivity >= 0 && s.emissivity <= 1)) {
    refuse(s, fmt::format("the emissivity is {}; it should be from 0 to 1", s.emissivity));
  }
  if (s.temperature.has_value() == s.heat_flux.has_value()) {
    refuse(s, "give either its temperature or its heat flux, one of the two");
  }
  if (s.temperature && !(*s.temperature >= 0 && std::isfinite(*s.temperature))) {
    refuse(s, fmt::format("the temperature is {} K; it should be 0 K or more", *s.temperature));
  }
  if (s.heat_flux && !std::isfinite(*s.heat_flux)) refuse(s, "the heat flux should be a finite number of W/m^2");
  if (s.heat_flux && s.emissivity == 0 && *s.heat_flux != 0) {
    refuse(s, "a perfect reflector (emissivity 0) exchanges no heat; its heat flux should be 0");
  }
}

// Rows that miss 1 by less than this are closed: factors have errors, and a closed enclosure should not leak by them.
constexpr double closed_within = 1e-12;

// Without a given temperature and without a way out for heat the level of temperature is free.
void check_level(const std::vector<HeatSurface>& surfaces, const FactorMatrix& factors) {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const bool anchored = surfaces[i].temperature && surfaces[i].emissivity > 0;
    if (anchored || 1 - factors.row_sum(i) > 1e-4) return;  // factors are seldom better
  }
  if (surfaces.empty()) return;
  throw std::invalid_argument(
      "no surface has a temperature and nothing leaves the enclosure, so that any temperature would do; give at least "
      "one");
}

/// Band 0 holds the sources of heat, band 1 the sinks: radiosities of a problem are not negative.
RadiosityProblem make_problem(const std::vector<HeatSurface>& surfaces, const FactorMatrix& factors,
                              double surroundings) {
  RadiosityProblem problem;
  problem.bands = 2;
  problem.areas = factors.areas;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const HeatSurface& s = surfaces[i];
    const double reflectance = s.heat_flux ? 1 : 1 - s.emissivity;
    const double emitted = s.heat_flux ? *s.heat_flux : s.emissivity * stefan_boltzmann * fourth_power(*s.temperature);
    const double open = std::max(0.0, 1 - factors.row_sum(i));
    problem.reflectance.insert(problem.reflectance.end(), 2, reflectance);
    problem.emission.insert(problem.emission.end(), {std::max(emitted, 0.0), std::max(-emitted, 0.0)});
    problem.irradiance.insert(problem.irradiance.end(), {open > closed_within ? open * surroundings : 0.0, 0.0});
  }
  return problem;
}

/// Temperature and net flux of each surface from what arrives, each by the equation that was not solved.
void finish_surface(const HeatSurface& s, std::size_t i, HeatExchange& result) {
  if (s.temperature) {
    result.temperature[i] = *s.temperature;
    const double black = stefan_boltzmann * fourth_power(*s.temperature);
    result.heat_flux[i] = s.emissivity * (black - result.irradiance[i]);
    return;
  }
  result.heat_flux[i] = result.radiosity[i] - result.irradiance[i];
  if (s.emissivity == 0) {
    result.temperature[i] = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const double black = result.irradiance[i] + *s.heat_flux / s.emissivity;
  if (black < -1e-9 * std::max(result.irradiance[i], std::abs(*s.heat_flux)) && result.converged) {
    refuse(s, fmt::format("a heat flux of {} W/m^2 takes more heat than arrives; no temperature can do that (at 0 K it "
                          "takes {:.6g} W/m^2)",
                          *s.heat_flux, -s.emissivity * result.irradiance[i]));
  }
  result.temperature[i] = std::pow(std::max(black, 0.0) / stefan_boltzmann, 0.25);
}

void add_balance(const FactorMatrix& factors, double surroundings, HeatExchange& result) {
  for (std::size_t i = 0; i < factors.rows(); ++i) {
    result.heat.push_back(factors.areas[i] * result.heat_flux[i]);
    (result.heat[i] > 0 ? result.supplied : result.removed) += result.heat[i];
    const double open = std::max(0.0, 1 - factors.row_sum(i));
    if (open > closed_within) result.to_surroundings += factors.areas[i] * open * (result.radiosity[i] - surroundings);
  }
  result.imbalance = result.supplied + result.removed - result.to_surroundings;
}

}  // namespace

HeatExchange solve_heat_exchange(const std::vector<HeatSurface>& surfaces, const FactorMatrix& factors,
                                 const HeatExchangeOptions& options) {
  if (surfaces.size() != factors.rows()) {
    throw std::invalid_argument(
        fmt::format("{} surfaces are described, but the factors are of {}", surfaces.size(), factors.rows()));
  }
  if (!(options.surroundings_temperature >= 0 && std::isfinite(options.surroundings_temperature))) {
    throw std::invalid_argument("the temperature of the surroundings should be 0 K or more");
  }
  for (const HeatSurface& s : surfaces) check(s);
  check_level(surfaces, factors);

  const double surroundings = stefan_boltzmann * fourth_power(options.surroundings_temperature);
  const RadiosityProblem problem = make_problem(surfaces, factors, surroundings);
  SolverOptions solver;
  solver.tolerance = options.tolerance;
  solver.max_iterations = options.max_iterations;
  solver.progress = options.progress;
  const RadiositySolution solution = surfaces.size() <= options.most_direct
                                         ? solve_direct(problem, factors, solver)
                                         : solve_gauss_seidel(problem, factors, solver);
  HeatExchange result;
  result.iterations = solution.iterations;
  result.residual = solution.residuals.empty() ? 0 : solution.residuals.back();
  result.converged = solution.converged;
  result.partial = solution.partial;
  result.temperature.resize(surfaces.size());
  result.heat_flux.resize(surfaces.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    result.radiosity.push_back(solution.radiosity[2 * i] - solution.radiosity[2 * i + 1]);
    result.irradiance.push_back(solution.irradiance[2 * i] - solution.irradiance[2 * i + 1]);
    finish_surface(surfaces[i], i, result);
  }
  add_balance(factors, surroundings, result);
  return result;
}

}  // namespace penumbra
