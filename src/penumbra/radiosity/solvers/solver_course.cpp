#include "penumbra/radiosity/solvers/solver_course.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace penumbra {
namespace {

/// Residuals that have grown by this factor will not fall again.
constexpr double diverged = 1e9;

}  // namespace

SolverCourse::SolverCourse(const SolverOptions& options, std::size_t safe_limit)
    : options_(options), limit_(options.max_iterations > 0 ? options.max_iterations : safe_limit) {
  if (!(options.tolerance >= 0)) throw std::invalid_argument("the solver's tolerance should not be negative");
  if (!(options.most_unshot >= 0)) throw std::invalid_argument("the share left unshot should not be negative");
  if (!(options.stop_at > 0 && options.stop_at <= 1)) {
    throw std::invalid_argument("the fraction of energy to shoot should be above 0 and at most 1");
  }
  options.progress.tell("solve", 0);
}

void SolverCourse::note(std::size_t count, double residual, double left, double shot,
                        const std::vector<double>& radiosity, const std::vector<double>& unshot) {
  iterations_ += count;
  residuals_.push_back(residual);
  if (options_.on_stage) options_.on_stage({iterations_, radiosity, unshot, residual});
  converged_ = residual == 0 || (accurate(residual) && left <= options_.most_unshot) ||
               (options_.stop_at < 1 && shot >= options_.stop_at);
  partial_ = !converged_ && options_.progress.stop_requested();
  // Rows that sum to more than 1 can make light grow without end, and soon beyond all numbers.
  if (residual > diverged * residuals_.front()) limit_ = iterations_;

  // Residuals fall geometrically: progress is even in their logarithm.
  double done = static_cast<double>(iterations_) / static_cast<double>(limit_);
  const double first = residuals_.front();
  if (options_.tolerance > 0 && residual > 0 && first > options_.tolerance) {
    done = std::max(done, std::log(first / residual) / std::log(first / options_.tolerance));
  }
  told_ = converged_ ? 1 : std::clamp(done, told_, 1.0);
  options_.progress.tell("solve", told_);
}

void SolverCourse::record(RadiositySolution& solution) const {
  solution.residuals = residuals_;
  solution.iterations = iterations_;
  solution.converged = converged_;
  solution.partial = partial_;
}

}  // namespace penumbra
