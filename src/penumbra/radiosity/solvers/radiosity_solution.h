#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"

namespace penumbra {

/// Where the energy went, W, summed over bands. In equilibrium emitted = absorbed + escaped; before, the difference is
/// what is still unshot. Each term is computed from its own definition, so that the balance is a test.
struct EnergyBalance {
  double emitted = 0;   ///< sum of A_i E_i and of what the other lights emit
  double absorbed = 0;  ///< sum of A_i (1 - rho_i) H_i, H_i the irradiance of element i from everywhere
  double escaped = 0;   ///< sum of A_i B_i (1 - sum_j F_ij), and what the other lights send past all elements
  double unshot = 0;    ///< sum of A_i times the radiosity that was not yet sent on
};

/// A state of the iteration, shown as it goes: after each bounce, sweep or shot.
struct SolverStage {
  std::size_t iteration = 0;             ///< from 1
  const std::vector<double>& radiosity;  ///< W/m^2, as known now (shooting: without the ambient term)
  const std::vector<double>& unshot;     ///< W/m^2, of `shooting`; else empty
  double residual = 0;                   ///< largest residual / largest emission
};

/// When the iteration ends: as soon as any criterion that applies holds.
struct SolverOptions {
  /// Largest residual of the equation over the largest source (E_i + rho_i H_i), over all elements and bands. 0: never.
  double tolerance = 1e-4;
  /// The tolerance counts as met only when no more than this share of the emitted energy is unshot (the sum of A_i
  /// times the absolute residual): small residuals everywhere may be much light together. 1e-4 leaves an error of about
  /// 1e-4 / (1 - mean reflectance) in the mean. Infinite: residuals alone count.
  double most_unshot = 1e-4;
  /// Fraction of the emitted energy that was shot (shooting, progressive). 1: never.
  double stop_at = 0.9999;
  /// Sweeps, bounces or shots; 0: no limit but a safe one.
  std::size_t max_iterations = 0;
  Progress progress;
  std::function<void(const SolverStage&)> on_stage;
};

/// What a solver found.
struct RadiositySolution {
  std::vector<double> radiosity;   ///< B, [element * bands + band], W/m^2
  std::vector<double> irradiance;  ///< from everywhere, [element * bands + band], W/m^2
  std::vector<double> residuals;   ///< per iteration: largest residual / largest source
  std::size_t iterations = 0;
  bool converged = false;      ///< a criterion for accuracy was met (not only max_iterations)
  bool partial = false;        ///< stopped from outside
  double unshot_fraction = 0;  ///< of the emitted energy
  EnergyBalance energy;
  /// Bound on |B_i - exact B_i| of the discrete system, W/m^2: the largest residual over 1 - max_i rho_i sum_j F_ij;
  /// infinite when that is not positive (a row of 1 or more with reflectance 1).
  double error_bound = std::numeric_limits<double>::infinity();
};

}  // namespace penumbra
