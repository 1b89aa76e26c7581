#pragma once

#include <span>
#include <string_view>

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// The solvers that this build knows, as on the command line, in the order of the textbook.
[[nodiscard]] std::span<const std::string_view> solver_names();

/// Solves the radiosity equation on a matrix of factors by the solver of that name. All have the same fixed point; each
/// says in its own header how it goes there, which options it reads and what its residuals are.
/// Throws std::invalid_argument for an unknown name (naming the known ones) and as the solver does.
[[nodiscard]] RadiositySolution solve_radiosity(std::string_view name, const RadiosityProblem& problem,
                                                const FactorMatrix& factors, const SolverOptions& options = {});

}  // namespace penumbra
