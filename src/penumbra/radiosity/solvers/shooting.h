#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/radiosity/solvers/factor_rows.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// The elements that should shoot next: those of most unshot energy (W, >= 0), the greatest first (ties by number), at
/// most `most` and none with less than a quarter of the greatest.
[[nodiscard]] std::vector<std::uint32_t> choose_shooters(std::span<const double> energy, std::size_t most);

struct ShootingOptions {
  /// Shooters whose rows are computed at once. The result depends on it, on threads or ranks it does not.
  std::size_t at_once = 16;
};

/// Solves the radiosity equation by shooting (Southwell's relaxation; Cohen, Chen, Wallace & Greenberg 1988,
/// 'progressive refinement'): the elements s with the most unshot energy A_s dB_s send it to all others j,
///
///     dH_j = F_sj A_s / A_j dB_s,    H_j += dH_j,    B_j += rho_j dH_j,    dB_j += rho_j dH_j,    dB_s = 0,
///
/// started at B = dB = E + rho H. Only the shooters' rows are ever asked for: memory is O(n) when `rows` computes them.
/// A batch of shooters is chosen by energy (ties by number; none with less than a quarter of the greatest), their rows
/// are computed on all threads, and each element receives from them in their order: the shape of Yu, Ibarra & Yang
/// (1996), with the same bits on any number of threads. The unshot energy falls with each batch (as long as rows sum to
/// at most 1).
///
/// One iteration is one shot; a stage and a residual are noted a batch. The residual is bounded by the largest unshot
/// radiosity times the largest reflectance of its band, rows taken to sum to at most 1; `error_bound` follows from it.
/// Radiosity and irradiance are what was sent until then, without ambient term (see ambient.h). `escaped` is what the
/// shots sent past all elements. Ends on tolerance, stop_at, max_iterations (shots) or stop.
/// Throws std::invalid_argument for a problem that is not valid, does not fit the rows, or options out of range.
[[nodiscard]] RadiositySolution solve_shooting(const RadiosityProblem& problem, const FactorRowSource& rows,
                                               const SolverOptions& options = {}, const ShootingOptions& shooting = {});

/// The same on the rows of a matrix.
[[nodiscard]] RadiositySolution solve_shooting(const RadiosityProblem& problem, const FactorMatrix& factors,
                                               const SolverOptions& options = {}, const ShootingOptions& shooting = {});

}  // namespace penumbra
