#pragma once

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// Solves the radiosity equation by the iteration of Gauss and Seidel (1874; in radiosity Cohen & Greenberg 1985): each
/// element in turn gathers with the newest values of all others,
///
///     B_i = (S_i + rho_i sum_{j != i} F_ij B_j) / (1 - rho_i F_ii),    S_i = E_i + rho_i H_i,
///
/// started at B = S; about half as many sweeps as Jacobi. Small systems go element by element. Large ones go by 64
/// blocks of consecutive elements: within a block all threads gather at once from the values before it, so that blocks,
/// and with them all bits, depend on the system alone. Neighbours mostly lie on one face and do not see each other:
/// that costs next to no sweeps.
///
/// The residual of a sweep is the largest change that it made times its diagonal, an upper bound of the residual after
/// the sweep wherever rho_i sum_j F_ij <= 1; those near the end are exact. Ends on tolerance, max_iterations or stop.
/// Throws std::invalid_argument for a problem that is not valid, does not fit the factors, or options out of range.
[[nodiscard]] RadiositySolution solve_gauss_seidel(const RadiosityProblem& problem, const FactorMatrix& factors,
                                                   const SolverOptions& options = {});

}  // namespace penumbra
