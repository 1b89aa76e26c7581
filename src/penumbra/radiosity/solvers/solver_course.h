#pragma once

#include <cstddef>
#include <vector>

#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// The course of an iteration: it counts, keeps the residuals, tells the stages and knows when to end.
class SolverCourse {
 public:
  /// @param safe_limit of iterations where the options set none.
  SolverCourse(const SolverOptions& options, std::size_t safe_limit);

  /// Whether another iteration is allowed and wanted.
  [[nodiscard]] bool goes_on() const { return !converged_ && !partial_ && iterations_ < limit_; }
  /// How many iterations are left.
  [[nodiscard]] std::size_t left() const { return limit_ - iterations_; }
  [[nodiscard]] std::size_t iterations() const { return iterations_; }

  /// After `count` more iterations. @param residual largest residual over largest source.
  /// @param left the fraction of the emitted energy that the residuals are, signs aside.
  /// @param shot the fraction of the emitted energy that was shot, where the criterion `stop_at` applies; else 0.
  void note(std::size_t count, double residual, double left, double shot, const std::vector<double>& radiosity,
            const std::vector<double>& unshot);
  /// Whether a residual meets the tolerance, as far as residuals alone decide.
  [[nodiscard]] bool accurate(double residual) const { return residual <= options_.tolerance || residual == 0; }

  /// Puts residuals, count and how it ended into a solution.
  void record(RadiositySolution& solution) const;

 private:
  const SolverOptions& options_;
  std::size_t limit_ = 0;
  std::size_t iterations_ = 0;
  std::vector<double> residuals_;
  double told_ = 0;
  bool converged_ = false;
  bool partial_ = false;
};

}  // namespace penumbra
