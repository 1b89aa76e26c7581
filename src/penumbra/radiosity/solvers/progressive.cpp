#include "penumbra/radiosity/solvers/progressive.h"

#include <utility>

#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/radiosity/solvers/radiosity_equation.h"
#include "penumbra/radiosity/solvers/solver_course.h"

namespace penumbra {

RadiositySolution solve_progressive(const RadiosityProblem& problem, const FactorMatrix& factors,
                                    const SolverOptions& options) {
  const RadiosityEquation equation(problem, factors);
  SolverCourse course(options, 100000);
  const double emitted = emitted_power(problem);
  std::vector<double> radiosity = problem.emission;
  RadiosityEquation::State state;
  equation.evaluate(radiosity, state);
  while (course.goes_on()) {
    for (std::size_t k = 0; k < radiosity.size(); ++k) radiosity[k] += state.residual[k];
    equation.evaluate(radiosity, state);
    const double unshot = power_of(problem, state.residual);
    course.note(1, equation.relative(state.largest_residual), equation.unshot_fraction(state),
                emitted > 0 ? 1 - unshot / emitted : 1, radiosity, {});
  }
  RadiositySolution solution = equation.describe(std::move(radiosity), std::move(state));
  course.record(solution);
  return solution;
}

}  // namespace penumbra
