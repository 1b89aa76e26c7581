#include "penumbra/radiosity/solvers/gauss_seidel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/solvers/radiosity_equation.h"
#include "penumbra/radiosity/solvers/solver_course.h"

namespace penumbra {
namespace {

/// Below this many factors a sweep is over before threads are worth their start.
constexpr std::size_t small_system = 1000000;
constexpr std::size_t blocks_of_large = 64;
constexpr std::size_t rows_a_task = 8;

/// A sweep over all elements, block by block; keeps the room it needs.
class Sweep {
 public:
  explicit Sweep(const RadiosityEquation& equation) : equation_(equation) {
    const std::size_t n = equation.problem().element_count();
    const bool small = equation.factors().values.size() < small_system;
    block_ = small ? 1 : (n + blocks_of_large - 1) / blocks_of_large;
    gathered_.resize(block_ * equation.problem().bands);
  }

  /// Returns the largest residual met.
  double run(std::vector<double>& radiosity) {
    const std::size_t n = equation_.problem().element_count();
    double largest = 0;
    for (std::size_t first = 0; first < n; first += block_) {
      const std::size_t last = std::min(n, first + block_);
      gather(first, last, radiosity);
      largest = std::max(largest, update(first, last, radiosity));
    }
    return largest;
  }

 private:
  void gather(std::size_t first, std::size_t last, const std::vector<double>& radiosity) {
    const std::size_t bands = equation_.problem().bands;
    if (block_ == 1) return equation_.gather(first, last, radiosity, gathered_);
    parallel_for(last - first, rows_a_task, [&](std::size_t a, std::size_t b) {
      equation_.gather(first + a, first + b, radiosity, std::span(gathered_).subspan(a * bands, (b - a) * bands));
    });
  }

  double update(std::size_t first, std::size_t last, std::vector<double>& radiosity) {
    const RadiosityProblem& problem = equation_.problem();
    double largest = 0;
    for (std::size_t k = first * problem.bands; k < last * problem.bands; ++k) {
      const double reflected = problem.reflectance[k] * gathered_[k - first * problem.bands];
      const double residual = equation_.source()[k] + reflected - radiosity[k];
      radiosity[k] += residual / equation_.diagonal(k);
      largest = std::max(largest, std::abs(residual));
    }
    return largest;
  }

  const RadiosityEquation& equation_;
  std::size_t block_ = 1;
  std::vector<double> gathered_;
};

}  // namespace

RadiositySolution solve_gauss_seidel(const RadiosityProblem& problem, const FactorMatrix& factors,
                                     const SolverOptions& options) {
  const RadiosityEquation equation(problem, factors);
  SolverCourse course(options, 100000);
  std::vector<double> radiosity = equation.source();
  RadiosityEquation::State state;
  Sweep sweep(equation);
  bool evaluated = false;
  while (course.goes_on()) {
    double residual = equation.relative(sweep.run(radiosity));
    // The bound is above the residual: the true one is asked for when it matters.
    evaluated = course.accurate(residual * std::min(1.0, equation.contraction())) || course.left() == 1;
    if (evaluated) {
      equation.evaluate(radiosity, state);
      residual = equation.relative(state.largest_residual);
    }
    // Before it was evaluated no unshot energy is known, and none is asked for.
    course.note(1, residual, evaluated ? equation.unshot_fraction(state) : 1, 0, radiosity, {});
  }
  if (!evaluated) equation.evaluate(radiosity, state);
  RadiositySolution solution = equation.describe(std::move(radiosity), std::move(state));
  course.record(solution);
  return solution;
}

}  // namespace penumbra
