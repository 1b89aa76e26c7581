#pragma once

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// Solves the radiosity equation by Jacobi's iteration (1845): every element gathers from the last iterate,
///
///     B_i' = (S_i + rho_i sum_{j != i} F_ij B_j) / (1 - rho_i F_ii),    S_i = E_i + rho_i H_i,
///
/// started at B = S. The error falls by max_i rho_i sum_j F_ij a sweep or faster. Rows are shared out over all threads.
/// One sweep costs one pass over the factors, the residual included. Ends on tolerance, max_iterations or stop.
/// Throws std::invalid_argument for a problem that is not valid, does not fit the factors, or options out of range.
[[nodiscard]] RadiositySolution solve_jacobi(const RadiosityProblem& problem, const FactorMatrix& factors,
                                             const SolverOptions& options = {});

}  // namespace penumbra
