#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// The discrete radiosity equation B = S + K B of a problem on given factors, with the source S_i = E_i + rho_i H_i and
/// K_ij = rho_i (F_ij + X_ij), X being light by way of mirrors and glass: what every matrix solver asks of it. Problem
/// and factors must outlive it.
///
/// Work is shared out by rows and each row is summed in the order of its columns: the same bits on any thread count.
class RadiosityEquation {
 public:
  /// Throws std::invalid_argument when the problem is not valid or has another size than the factors.
  RadiosityEquation(const RadiosityProblem& problem, const FactorMatrix& factors);

  [[nodiscard]] const RadiosityProblem& problem() const { return problem_; }
  [[nodiscard]] const FactorMatrix& factors() const { return factors_; }
  [[nodiscard]] std::size_t value_count() const { return source_.size(); }
  /// S, [element * bands + band], W/m^2.
  [[nodiscard]] const std::vector<double>& source() const { return source_; }
  [[nodiscard]] double largest_source() const { return largest_source_; }
  /// max_i rho_i sum_j (F_ij + X_ij): the factor by which the error of an iterate falls at least with a bounce.
  [[nodiscard]] double contraction() const { return contraction_; }
  /// 1 - rho_i F_ii (X_ii left to the iteration), or 1 where that is not positive.
  [[nodiscard]] double diagonal(std::size_t value) const;

  /// sum_j (F_ij + X_ij) B_j for the rows [first, last), on this thread. @param radiosity of all elements.
  /// @param gathered [(i - first) * bands + band].
  void gather(std::size_t first, std::size_t last, std::span<const double> radiosity, std::span<double> gathered) const;

  /// The state of an iterate B, computed on all threads.
  struct State {
    std::vector<double> irradiance;  ///< from everywhere, W/m^2
    std::vector<double> residual;    ///< E + rho irradiance - B, W/m^2
    double largest_residual = 0;     ///< of all absolute values, W/m^2
    double unshot = 0;               ///< W: sum of A_i |residual|, over bands
  };
  void evaluate(std::span<const double> radiosity, State& state) const;

  /// The largest residual relative to the largest source; 0 when there is no light.
  [[nodiscard]] double relative(double residual) const;

  /// The state's `unshot` as a fraction of what is emitted; 0 when there is no light.
  [[nodiscard]] double unshot_fraction(const State& state) const;

  /// What is known about the iterate `radiosity` whose state is `state`: error bound and energy.
  [[nodiscard]] RadiositySolution describe(std::vector<double> radiosity, State state) const;

 private:
  const RadiosityProblem& problem_;
  const FactorMatrix& factors_;
  std::vector<double> lights_;  ///< H, empty when every light is an element
  std::vector<double> source_;
  std::vector<double> self_factors_;  ///< F_ii
  double largest_source_ = 0;
  double contraction_ = 0;
  double emitted_ = 0;  ///< W
};

}  // namespace penumbra
