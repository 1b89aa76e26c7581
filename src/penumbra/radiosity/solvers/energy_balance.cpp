#include "penumbra/radiosity/solvers/energy_balance.h"

#include <cassert>

namespace penumbra {

double power_of(const RadiosityProblem& problem, std::span<const double> values) {
  assert(values.size() == problem.element_count() * problem.bands);
  double power = 0;
  for (std::size_t i = 0; i < problem.element_count(); ++i) {
    for (std::size_t b = 0; b < problem.bands; ++b) power += problem.areas[i] * values[i * problem.bands + b];
  }
  return power;
}

double power_past_all(const RadiosityProblem& problem) {
  if (problem.light_power.empty()) return 0;
  double power = problem.irradiance.empty() ? 0 : -power_of(problem, problem.irradiance);
  for (const double flux : problem.light_power) power += flux;
  return power;
}

double emitted_power(const RadiosityProblem& problem) {
  double power = power_of(problem, problem.emission);
  for (const double flux : problem.light_power) power += flux;
  if (problem.light_power.empty() && !problem.irradiance.empty()) power += power_of(problem, problem.irradiance);
  return power;
}

double absorbed_power(const RadiosityProblem& problem, std::span<const double> irradiance) {
  double power = 0;
  for (std::size_t i = 0; i < problem.element_count(); ++i) {
    for (std::size_t b = 0; b < problem.bands; ++b) {
      const std::size_t k = i * problem.bands + b;
      power += problem.areas[i] * (1 - problem.reflectance[k]) * irradiance[k];
    }
  }
  return power;
}

SpecularFlow specular_flow(const RadiosityProblem& problem, std::span<const double> radiosity) {
  SpecularFlow flow;
  if (!problem.specular_irradiance.empty()) flow.arrived = power_of(problem, problem.specular_irradiance);
  if (!problem.specular) return flow;
  std::vector<double> irradiance(radiosity.size(), 0.0);
  problem.specular->gather(0, problem.element_count(), radiosity, irradiance);
  flow.arrived += power_of(problem, irradiance);
  for (std::size_t k = 0; k < radiosity.size(); ++k) {
    flow.left += problem.areas[k / problem.bands] * static_cast<double>(problem.specular->leaving[k]) * radiosity[k];
  }
  return flow;
}

EnergyBalance energy_balance(const RadiosityProblem& problem, const FactorMatrix& factors,
                             std::span<const double> radiosity, std::span<const double> irradiance,
                             std::span<const double> unshot) {
  EnergyBalance energy;
  energy.emitted = emitted_power(problem);
  energy.absorbed = absorbed_power(problem, irradiance);
  energy.escaped = power_past_all(problem);
  for (std::size_t i = 0; i < problem.element_count(); ++i) {
    const double open = 1 - factors.row_sum(i);
    for (std::size_t b = 0; b < problem.bands; ++b) {
      energy.escaped += problem.areas[i] * radiosity[i * problem.bands + b] * open;
    }
  }
  const SpecularFlow flow = specular_flow(problem, radiosity);
  energy.absorbed -= flow.arrived + flow.left;
  energy.escaped += flow.left;
  energy.unshot = power_of(problem, unshot);
  return energy;
}

}  // namespace penumbra
