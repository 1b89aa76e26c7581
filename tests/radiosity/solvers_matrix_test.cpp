#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/solvers/direct.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/radiosity/solvers/gauss_seidel.h"
#include "penumbra/radiosity/solvers/jacobi.h"
#include "penumbra/radiosity/solvers/progressive.h"
#include "penumbra/radiosity/solvers/solver.h"
#include "radiosity/enclosures.h"

namespace penumbra {
namespace {

using test::convex_factors;
using test::element_mesh;
using test::largest_difference;
using test::random_problem;
using test::room_elements;
using test::uniform_problem;

/// Goes on until the equation holds to rounding.
SolverOptions strict() {
  SolverOptions options;
  options.tolerance = 1e-13;
  options.stop_at = 1;
  return options;
}

FactorMatrix cavity_factors(unsigned seed) { return convex_factors(element_mesh(Dice(seed).convex_cavity(20))); }

FactorMatrix room_factors(int n) { return convex_factors(element_mesh(room_elements({3, 4, 2}, n))); }

// Any closed scene of one emission and one reflectance is a furnace (Smits & Jensen 2000): B = E / (1 - rho).
TEST(MatrixSolvers, AFurnaceIsUniform) {
  const FactorMatrix factors = cavity_factors(3);
  for (const std::string_view name : solver_names()) {
    for (const double rho : {0.1, 0.5, 0.8, 0.9, 0.99}) {
      const auto solution = solve_radiosity(name, uniform_problem(factors.areas, 3, rho, 1), factors, strict());
      EXPECT_TRUE(solution.converged) << name;
      for (const double b : solution.radiosity) EXPECT_NEAR(b, 1 / (1 - rho), 1e-9 / (1 - rho)) << name << rho;
      for (const double h : solution.irradiance) EXPECT_NEAR(h, 1 / (1 - rho), 1e-9 / (1 - rho)) << name << rho;
    }
  }
}

// After k bounces the furnace has E (1 - rho^(k+1)) / (1 - rho).
TEST(ProgressiveSolver, EachBounceOfAFurnaceIsATermOfTheSeries) {
  const FactorMatrix factors = cavity_factors(4);
  SolverOptions options = strict();
  options.max_iterations = 12;
  for (const double rho : {0.1, 0.5, 0.8, 0.9, 0.99}) {
    std::size_t stages = 0;
    options.on_stage = [&](const SolverStage& stage) {
      EXPECT_EQ(stage.iteration, ++stages);
      const double expected = (1 - std::pow(rho, static_cast<double>(stages) + 1)) / (1 - rho);
      for (const double b : stage.radiosity) EXPECT_NEAR(b, expected, 1e-9 * expected);
    };
    const auto solution = solve_progressive(uniform_problem(factors.areas, 1, rho, 1), factors, options);
    EXPECT_EQ(solution.iterations, stages);
    EXPECT_EQ(solution.residuals.size(), stages);
  }
}

// Light from elsewhere makes its first bounce in the first pass.
TEST(ProgressiveSolver, CountsTheBouncesOfOtherLights) {
  const FactorMatrix factors = cavity_factors(5);
  RadiosityProblem problem = uniform_problem(factors.areas, 1, 0.5, 0);
  problem.irradiance.assign(factors.rows(), 2.0);
  SolverOptions options = strict();
  for (const auto& [bounces, expected] : {std::pair(1, 1.0), std::pair(2, 1.5), std::pair(3, 1.75)}) {
    options.max_iterations = static_cast<std::size_t>(bounces);
    const auto solution = solve_progressive(problem, factors, options);
    for (const double b : solution.radiosity) EXPECT_NEAR(b, expected, 1e-9);
    EXPECT_FALSE(solution.converged);
  }
}

TEST(MatrixSolvers, AgreeOnTheSameFactors) {
  for (const unsigned seed : {1U, 2U}) {
    const FactorMatrix factors = cavity_factors(seed);
    for (const std::size_t bands : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{4}, std::size_t{7}}) {
      const RadiosityProblem problem = random_problem(factors.areas, bands, seed);
      const auto exact = solve_radiosity("direct", problem, factors);
      for (const std::string_view name : solver_names()) {
        const auto solution = solve_radiosity(name, problem, factors, strict());
        EXPECT_LT(largest_difference(solution.radiosity, exact.radiosity), 1e-8) << name << bands;
        EXPECT_LT(largest_difference(solution.irradiance, exact.irradiance), 1e-8) << name << bands;
      }
    }
  }
}

// Elements of several patches may see themselves: F_ii > 0.
TEST(MatrixSolvers, AgreeOnElementsThatSeeThemselves) {
  const FactorMatrix factors = test::sparse({1, 2}, {{0.3, 0.7}, {0.35, 0.65}});
  const RadiosityProblem problem = random_problem(factors.areas, 3, 9);
  const auto exact = solve_direct(problem, factors);
  for (const std::string_view name : solver_names()) {
    const auto solution = solve_radiosity(name, problem, factors, strict());
    EXPECT_LT(largest_difference(solution.radiosity, exact.radiosity), 1e-9) << name;
  }
}

// Large systems are swept by blocks; blocks of elements on one face, or across faces, lead to the same end.
TEST(GaussSeidelSolver, ManyElementsAgreeWithJacobi) {
  const FactorMatrix factors = room_factors(15);
  ASSERT_GT(factors.values.size(), std::size_t{1000000});
  const RadiosityProblem problem = random_problem(factors.areas, 3, 7);
  SolverOptions options = strict();
  options.tolerance = 1e-10;
  const auto swept = solve_gauss_seidel(problem, factors, options);
  const auto jacobi = solve_jacobi(problem, factors, options);
  EXPECT_LT(largest_difference(swept.radiosity, jacobi.radiosity), 1e-8);
  EXPECT_LT(swept.iterations, 0.75 * static_cast<double>(jacobi.iterations));
}

TEST(MatrixSolvers, EnergyIsKeptAtEveryStage) {
  const FactorMatrix closed = room_factors(3);
  FactorMatrix open = closed;  // half of what each sends is lost
  for (double& f : open.values) f *= 0.5;
  for (const FactorMatrix* factors : {&closed, static_cast<const FactorMatrix*>(&open)}) {
    RadiosityProblem problem = random_problem(factors->areas, 3, 11);
    for (const bool with_power : {false, true}) {
      if (with_power) problem.light_power = {100, 200, 300};
      for (const std::string_view name : solver_names()) {
        for (const std::size_t limit : {1, 2, 5, 0}) {
          SolverOptions options = strict();
          options.max_iterations = limit;
          const EnergyBalance e = solve_radiosity(name, problem, *factors, options).energy;
          EXPECT_NEAR(e.emitted, e.absorbed + e.escaped + e.unshot, 1e-9 * e.emitted) << name << limit;
          EXPECT_LT(std::abs(e.unshot), (limit == 0 ? 1e-8 : 1.0) * e.emitted) << name;
          if (limit == 0 && !with_power && factors == &closed) {
            EXPECT_LT(std::abs(e.escaped), 1e-9 * e.emitted) << name;
          }
        }
      }
    }
  }
}

TEST(MatrixSolvers, TheErrorStaysBelowItsBound) {
  const FactorMatrix factors = cavity_factors(6);
  const RadiosityProblem problem = random_problem(factors.areas, 3, 13);
  const auto exact = solve_direct(problem, factors);
  for (const std::string_view name : solver_names()) {
    double last = std::numeric_limits<double>::infinity();
    for (const std::size_t limit : {1, 3, 9}) {
      SolverOptions options = strict();
      options.max_iterations = limit;
      const auto solution = solve_radiosity(name, problem, factors, options);
      EXPECT_LE(largest_difference(solution.radiosity, exact.radiosity), solution.error_bound + 1e-12) << name;
      // A shot may raise the largest unshot radiosity; sweeps and bounces lower the largest residual.
      if (name != "shooting") {
        EXPECT_LT(solution.error_bound, name == "direct" ? 1e-9 : last) << name;
      }
      last = solution.error_bound;
    }
  }
}

TEST(MatrixSolvers, AClosedSceneThatAbsorbsNothingHasNoBound) {
  const FactorMatrix factors = cavity_factors(6);
  SolverOptions options;
  options.max_iterations = 50;
  for (const std::string_view name : solver_names()) {
    const auto solution = solve_radiosity(name, uniform_problem(factors.areas, 1, 1, 1), factors, options);
    EXPECT_GT(solution.error_bound, 1e9) << name;
    EXPECT_FALSE(solution.converged && name != "direct") << name;
  }
}

// A small bright lamp in a large room: residuals far below its emission are still much of the light.
TEST(MatrixSolvers, DefaultsLeaveAThousandthOfTheLightAtMost) {
  const FactorMatrix factors = room_factors(4);
  RadiosityProblem problem = uniform_problem(factors.areas, 3, 0.7, 0);
  problem.emission[0] = problem.emission[1] = problem.emission[2] = 1;
  SolverOptions exact;
  exact.tolerance = 1e-13;
  const double all = power_of(problem, solve_gauss_seidel(problem, factors, exact).radiosity);
  for (const std::string_view name : solver_names()) {
    const auto solution = solve_radiosity(name, problem, factors, {});
    EXPECT_TRUE(solution.converged) << name;
    EXPECT_LE(std::abs(solution.unshot_fraction), 1e-4) << name;
    EXPECT_NEAR(power_of(problem, solution.radiosity), all, 1e-3 * all) << name;
  }
}

TEST(MatrixSolvers, EndWhereTheOptionsSay) {
  const FactorMatrix factors = room_factors(3);
  const RadiosityProblem problem = random_problem(factors.areas, 3, 17);
  for (const std::string_view name : {"jacobi", "gauss-seidel", "progressive"}) {
    SolverOptions options;
    options.tolerance = 1e-3;
    options.most_unshot = 2;
    options.stop_at = 1;
    const auto solution = solve_radiosity(name, problem, factors, options);
    EXPECT_TRUE(solution.converged) << name;
    EXPECT_LE(solution.residuals.back(), 1e-3) << name;
    EXPECT_GT(solution.residuals[solution.residuals.size() - 2], 1e-3) << name;
    options.max_iterations = 2;
    const auto cut = solve_radiosity(name, problem, factors, options);
    EXPECT_EQ(cut.iterations, std::size_t{2}) << name;
    EXPECT_FALSE(cut.converged || cut.partial) << name;
  }
  SolverOptions options;
  options.tolerance = 0;
  options.stop_at = 0.9;
  const auto solution = solve_progressive(problem, factors, options);
  EXPECT_TRUE(solution.converged);
  EXPECT_LE(solution.unshot_fraction, 0.1);
}

TEST(MatrixSolvers, AStoppedSolutionIsPartialAndHoldsWhatWasDone) {
  const FactorMatrix factors = room_factors(3);
  const RadiosityProblem problem = random_problem(factors.areas, 3, 17);
  for (const std::string_view name : {"jacobi", "gauss-seidel", "progressive"}) {
    std::stop_source stop;
    SolverOptions options = strict();
    options.progress.stop = stop.get_token();
    options.on_stage = [&](const SolverStage& stage) {
      if (stage.iteration == 3) stop.request_stop();
    };
    const auto stopped = solve_radiosity(name, problem, factors, options);
    EXPECT_TRUE(stopped.partial) << name;
    EXPECT_EQ(stopped.iterations, std::size_t{3}) << name;
    options = strict();
    options.max_iterations = 3;
    EXPECT_EQ(stopped.radiosity, solve_radiosity(name, problem, factors, options).radiosity) << name;
  }
}

TEST(MatrixSolversThreaded, GiveTheSameBitsOnAnyThreadCount) {
  const FactorMatrix factors = room_factors(15);
  const RadiosityProblem problem = random_problem(factors.areas, 3, 19);
  SolverOptions options;
  options.max_iterations = 3;
  for (const std::string_view name : solver_names()) {
    if (name == "direct") continue;  // one thread
    std::vector<double> first;
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      const auto solution = solve_radiosity(name, problem, factors, options);
      if (first.empty()) first = solution.radiosity;
      EXPECT_EQ(solution.radiosity, first) << name << threads;
    }
  }
}

TEST(MatrixSolvers, ADarkSceneIsBlack) {
  const FactorMatrix factors = cavity_factors(8);
  for (const std::string_view name : solver_names()) {
    const auto solution = solve_radiosity(name, uniform_problem(factors.areas, 3, 0.5, 0), factors);
    EXPECT_TRUE(solution.converged) << name;
    for (const double b : solution.radiosity) EXPECT_EQ(b, 0) << name;
  }
}

TEST(MatrixSolvers, ProgressNeverFalls) {
  const FactorMatrix factors = cavity_factors(8);
  const RadiosityProblem problem = random_problem(factors.areas, 3, 23);
  for (const std::string_view name : solver_names()) {
    SolverOptions options;
    double last = 0;
    options.progress.report = [&](std::string_view, double done) {
      EXPECT_GE(done, last) << name;
      EXPECT_LE(done, 1) << name;
      last = done;
    };
    (void)solve_radiosity(name, problem, factors, options);
    EXPECT_EQ(last, 1) << name;
  }
}

TEST(MatrixSolvers, RefuseWhatMakesNoSense) {
  const FactorMatrix factors = cavity_factors(8);
  const RadiosityProblem good = uniform_problem(factors.areas, 3, 0.5, 1);
  EXPECT_THROW((void)solve_radiosity("cholesky", good, factors), std::invalid_argument);
  RadiosityProblem bad = good;
  bad.areas.pop_back();
  EXPECT_THROW((void)solve_jacobi(bad, factors), std::invalid_argument);
  bad = good;
  bad.reflectance[4] = 1.5;
  EXPECT_THROW((void)solve_jacobi(bad, factors), std::invalid_argument);
  bad = good;
  bad.emission[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)solve_jacobi(bad, factors), std::invalid_argument);
  bad = good;
  bad.irradiance = {1};
  EXPECT_THROW((void)solve_jacobi(bad, factors), std::invalid_argument);
  EXPECT_THROW((void)solve_jacobi(uniform_problem({1, 2}, 3, 0.5, 1), factors), std::invalid_argument);
  SolverOptions options;
  options.stop_at = 2;
  EXPECT_THROW((void)solve_progressive(good, factors, options), std::invalid_argument);
  const std::vector<double> many(most_direct_elements + 1, 1.0);
  FactorMatrix empty;
  empty.areas = many;
  empty.offsets.assign(many.size() + 1, 0);
  EXPECT_THROW((void)solve_direct(uniform_problem(many, 1, 0.5, 1), empty), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
