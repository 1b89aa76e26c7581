#pragma once

#include <span>
#include <vector>

#include "penumbra/radiosity/solvers/radiosity_problem.h"

namespace penumbra {

/// The ambient radiosity of a scene in which `unshot` has not been sent on yet, W/m^2, a value a band (Cohen, Chen,
/// Wallace & Greenberg 1988, eq. 13): the unshot radiosity's mean over all area, times 1 / (1 - mean reflectance) for
/// the bounces to come. An empty unshot, or reflectance of 1 all over, has no ambient term: zeros.
[[nodiscard]] std::vector<double> ambient_radiosity(const RadiosityProblem& problem, std::span<const double> unshot);

/// A stage of shooting made fit to be looked at: B_i + rho_i ambient. For display only: it is no step of the solution.
[[nodiscard]] std::vector<double> with_ambient(const RadiosityProblem& problem, std::span<const double> radiosity,
                                               std::span<const double> unshot);

}  // namespace penumbra
