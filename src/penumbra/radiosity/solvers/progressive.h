#pragma once

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// Solves the radiosity equation bounce by bounce, the Neumann series (Kajiya 1986, eq. 6, in radiosities):
///
///     t_0 = E,    t_1 = rho (H + F t_0),    t_k = rho F t_{k-1},    B_k = t_0 + ... + t_k
///
/// After pass k the solution holds the light of exactly k bounces, whether it came from elements or from other lights:
/// B_k equals the k-th iterate of B' = S + K B started at B = E (Jacobi's where F_ii = 0). What is unshot after pass k
/// is t_{k+1}, which is also the residual. Ends on tolerance, stop_at (the fraction of the emitted energy), the number
/// of bounces or stop. Irradiance is that of B_k, one bounce further.
/// Throws std::invalid_argument for a problem that is not valid, does not fit the factors, or options out of range.
[[nodiscard]] RadiositySolution solve_progressive(const RadiosityProblem& problem, const FactorMatrix& factors,
                                                  const SolverOptions& options = {});

}  // namespace penumbra
