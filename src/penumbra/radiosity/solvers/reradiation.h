#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// Elements that radiate again, at longer wavelengths, what they absorb (fluorescence). Bands ascend in wavelength.
struct Reradiation {
  static constexpr std::uint32_t none = 0xffffffffU;

  /// Donaldson matrices, [out * bands + in]: of the irradiance in band `in`, the share that is radiosity in band `out`.
  /// Only out > in counts; the problem's reflectance stands for the diagonal.
  std::vector<std::vector<double>> matrices;
  std::vector<std::uint32_t> matrix_of;  ///< by element, or none; empty: no element radiates again
};

/// Solves the radiosity equation with fluorescent elements,
///
///     B_i[o] = E_i[o] + rho_i[o] G_i[o] + sum_{in < o} D_i[o][in] G_i[in],    G_i = H_i + sum_j F_ij B_j,
///
/// by the solver of that name. As light only goes to longer wavelengths the system is triangular in the bands: they are
/// solved one after another, the shortest first, and what a band's light excites is emission in those that follow.
///
/// The solution's iterations are those of all bands together, its residuals each band's last, its error bound the
/// largest of theirs (each band's own, with the light of shorter ones taken as it was found). Energy that is absorbed
/// and radiated again counts neither as emitted nor as absorbed. `options.on_stage` is not called.
/// Throws std::invalid_argument as the solver does, and for matrices of another size, with entries below 0 or above the
/// diagonal (radiating at shorter wavelengths than they absorb), or that pass on more than arrives: reflectance and the
/// entries below it sum to more than 1.
[[nodiscard]] RadiositySolution solve_with_reradiation(std::string_view solver, const RadiosityProblem& problem,
                                                       const Reradiation& reradiation, const FactorMatrix& factors,
                                                       const SolverOptions& options = {});

}  // namespace penumbra
