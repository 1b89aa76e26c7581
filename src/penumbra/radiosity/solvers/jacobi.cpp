#include "penumbra/radiosity/solvers/jacobi.h"

#include <utility>

#include "penumbra/radiosity/solvers/radiosity_equation.h"
#include "penumbra/radiosity/solvers/solver_course.h"

namespace penumbra {

RadiositySolution solve_jacobi(const RadiosityProblem& problem, const FactorMatrix& factors,
                               const SolverOptions& options) {
  const RadiosityEquation equation(problem, factors);
  SolverCourse course(options, 100000);
  std::vector<double> radiosity = equation.source();
  RadiosityEquation::State state;
  equation.evaluate(radiosity, state);
  while (course.goes_on()) {
    for (std::size_t k = 0; k < radiosity.size(); ++k) radiosity[k] += state.residual[k] / equation.diagonal(k);
    equation.evaluate(radiosity, state);
    course.note(1, equation.relative(state.largest_residual), equation.unshot_fraction(state), 0, radiosity, {});
  }
  RadiositySolution solution = equation.describe(std::move(radiosity), std::move(state));
  course.record(solution);
  return solution;
}

}  // namespace penumbra
