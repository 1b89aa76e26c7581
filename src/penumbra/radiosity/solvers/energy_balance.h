#pragma once

#include <span>

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// What the elements and the other lights emit, W, summed over bands.
[[nodiscard]] double emitted_power(const RadiosityProblem& problem);

/// What the other lights send past all elements, W, summed over bands: their power less the sum of A_i H_i.
[[nodiscard]] double power_past_all(const RadiosityProblem& problem);

/// Sum over elements and bands of A_i values_i, W.
[[nodiscard]] double power_of(const RadiosityProblem& problem, std::span<const double> values);

/// Sum of A_i (1 - rho_i) H_i, W. @param irradiance from everywhere, W/m^2. What mirrors and glass pass on is in it:
/// see SpecularFlow.
[[nodiscard]] double absorbed_power(const RadiosityProblem& problem, std::span<const double> irradiance);

/// Light that specular elements pass on, W, summed over bands: it arrives twice, at them and where it ends.
struct SpecularFlow {
  double arrived = 0;  ///< at elements by way of mirrors and glass
  double left = 0;     ///< the scene that way
};
[[nodiscard]] SpecularFlow specular_flow(const RadiosityProblem& problem, std::span<const double> radiosity);

/// The balance of a state in which every element has sent out `radiosity`, received `irradiance` (from everywhere) and
/// still holds back `unshot` (W/m^2; the residual E + rho H - B of an iterate B). Whatever the state, emitted =
/// absorbed + escaped + unshot to rounding, as long as the factors are reciprocal.
[[nodiscard]] EnergyBalance energy_balance(const RadiosityProblem& problem, const FactorMatrix& factors,
                                           std::span<const double> radiosity, std::span<const double> irradiance,
                                           std::span<const double> unshot);

}  // namespace penumbra
