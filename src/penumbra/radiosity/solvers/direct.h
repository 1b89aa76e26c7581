#pragma once

#include <cstddef>

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// The most elements that `solve_direct` takes: its matrix of n^2 doubles is then half a gigabyte.
inline constexpr std::size_t most_direct_elements = 8000;

/// Throws std::invalid_argument for more than that: before the factors are computed is the time to say so.
void refuse_what_direct_does_not_take(std::size_t elements);

/// Solves the radiosity equation exactly, to rounding: (I - diag(rho) F) B = S, S_i = E_i + rho_i H_i (Goral, Torrance,
/// Greenberg & Battaile 1984, eq. 9), by LU with partial pivoting, one factorisation for each band of its own
/// reflectance. Time grows as n^3, memory as n^2: for small scenes and as a reference. On one thread.
///
/// `iterations` is 1. Not converged when the system is singular (a closed scene that absorbs nothing) or the residual
/// is above the tolerance and 1e-9. May be stopped between bands: those not yet solved then hold their source.
/// Throws std::invalid_argument for more than `most_direct_elements`, for a problem that is not valid or does not fit
/// the factors.
[[nodiscard]] RadiositySolution solve_direct(const RadiosityProblem& problem, const FactorMatrix& factors,
                                             const SolverOptions& options = {});

}  // namespace penumbra
