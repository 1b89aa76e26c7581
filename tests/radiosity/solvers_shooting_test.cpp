#include "penumbra/radiosity/solvers/shooting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <stop_token>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/solvers/ambient.h"
#include "penumbra/radiosity/solvers/direct.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "radiosity/enclosures.h"

namespace penumbra {
namespace {

using test::convex_factors;
using test::element_mesh;
using test::largest_difference;
using test::random_problem;
using test::room_elements;
using test::uniform_problem;

/// A room with a plate in it, so that something hides something.
PatchMesh room_with_plate(int n) {
  std::vector<Polygon> elements = room_elements({3, 4, 2}, n);
  const Polygon plate = floor_rectangle(1, 2, 1.5, 2.5, 0.8);
  for (const Polygon& side : {plate, reversed(plate)})
    for (Polygon& cell : test::grid(side, 3, 3)) elements.push_back(std::move(cell));
  return element_mesh(elements, 3);
}

TEST(ShootingSolver, UnshotEnergyFallsWithEveryBatch) {
  const FactorMatrix factors = convex_factors(element_mesh(room_elements({3, 4, 2}, 4)));
  const RadiosityProblem problem = random_problem(factors.areas, 3, 5);
  for (const std::size_t at_once : {1, 16}) {
    SolverOptions options;
    options.stop_at = 1;
    options.tolerance = 1e-8;
    double last = emitted_power(problem) * 1.0001;
    options.on_stage = [&](const SolverStage& stage) {
      const double unshot = power_of(problem, stage.unshot);
      EXPECT_LT(unshot, last);
      last = unshot;
    };
    const auto solution = solve_shooting(problem, factors, options, {at_once});
    EXPECT_TRUE(solution.converged);
    EXPECT_LT(solution.unshot_fraction, 1e-6);
  }
}

// What Southwell chose: the first shot of a scene with one emitter is the emitter's, and carries its light.
TEST(ShootingSolver, TheBrightestShootsFirst) {
  const FactorMatrix factors = convex_factors(element_mesh(room_elements({1, 1, 1}, 2)));
  RadiosityProblem problem = uniform_problem(factors.areas, 1, 0.5, 0);
  problem.emission[7] = 3;
  SolverOptions options;
  options.max_iterations = 1;
  const auto solution = solve_shooting(problem, factors, options);
  for (std::size_t j = 0; j < factors.rows(); ++j) {
    EXPECT_NEAR(solution.radiosity[j], problem.emission[j] + 0.5 * factors.at(j, 7) * 3, 1e-14);
  }
}

TEST(ShootingSolver, EnergyIsKeptAfterEveryBatch) {
  FactorMatrix factors = convex_factors(element_mesh(room_elements({3, 4, 2}, 3)));
  for (double& f : factors.values) f *= 0.7;  // open: 30 % of each row is lost
  const RadiosityProblem problem = random_problem(factors.areas, 3, 6);
  for (const std::size_t shots : {1, 10, 100, 0}) {
    SolverOptions options;
    options.max_iterations = shots;
    const auto solution = solve_shooting(problem, factors, options);
    const EnergyBalance& e = solution.energy;
    EXPECT_NEAR(e.emitted, e.absorbed + e.escaped + e.unshot, 1e-10 * e.emitted);
    EXPECT_GT(e.escaped, 0);
    EXPECT_GE(solution.radiosity.size(), factors.rows());
  }
}

// The residual that it states is above the one that the matrix has.
TEST(ShootingSolver, ResidualAndErrorStayBelowTheirBounds) {
  const FactorMatrix factors = convex_factors(element_mesh(Dice(3).convex_cavity(20)));
  const RadiosityProblem problem = random_problem(factors.areas, 3, 7);
  const auto exact = solve_direct(problem, factors);
  for (const std::size_t shots : {1, 10, 50, 200}) {
    SolverOptions options;
    options.max_iterations = shots;
    options.tolerance = 1e-12;
    options.stop_at = 1;
    const auto solution = solve_shooting(problem, factors, options);
    EXPECT_LE(largest_difference(solution.radiosity, exact.radiosity), solution.error_bound + 1e-12);
    EXPECT_LT(solution.error_bound, 100);
  }
}

// Rays and hemicubes at the shooter alone come to the matrix's solution within their own errors.
TEST(ShootingSolver, RowsComputedOnTheFlyGiveTheMatrixSolution) {
  const PatchMesh mesh = room_with_plate(3);
  const auto exact_method = make_form_factor_method("adaptive", mesh);
  const FactorMatrix factors = assemble_factor_matrix(*exact_method, mesh);
  SolverOptions until;
  until.stop_at = 0.999;
  RadiosityProblem problem = uniform_problem(factors.areas, 3, 0.6, 0);
  for (std::size_t k = 27; k < 54; ++k) problem.emission[k] = 1;  // the ceiling
  const auto exact = solve_direct(problem, factors);
  const double mean =
      power_of(problem, exact.radiosity) / power_of(problem, std::vector<double>(exact.radiosity.size(), 1.0));
  for (const auto& [name, error] : {std::pair("ray-cast", 0.03), {"hemicube", 0.01}, {"nusselt", 0.08}}) {
    FormFactorOptions options;
    options.rays = 4096;
    const auto method = make_form_factor_method(name, mesh, options);
    const auto solution = solve_shooting(problem, MethodRows(*method, mesh), until);
    double square = 0;
    for (std::size_t k = 0; k < exact.radiosity.size(); ++k) {
      square += (solution.radiosity[k] - exact.radiosity[k]) * (solution.radiosity[k] - exact.radiosity[k]);
    }
    const double rms = std::sqrt(square / static_cast<double>(exact.radiosity.size()));
    EXPECT_LT(rms, error * mean) << name;
    EXPECT_TRUE(solution.converged) << name;
    EXPECT_NEAR(solution.energy.emitted, solution.energy.absorbed + solution.energy.escaped + solution.energy.unshot,
                1e-10 * solution.energy.emitted);
  }
}

TEST(ShootingSolver, RefusesAMethodWithoutRows) {
  const PatchMesh mesh = element_mesh(room({1, 1, 1}));
  const auto method = make_form_factor_method("adaptive", mesh);
  EXPECT_THROW(MethodRows(*method, mesh), std::invalid_argument);
  EXPECT_THROW((void)method->row(0), std::logic_error);
}

// A row agrees with the blocks of its method, where those are the mean of both directions.
TEST(FactorRows, RowsOfPairMethodsAreThoseOfTheMatrix) {
  const PatchMesh mesh = room_with_plate(3);
  for (const std::string_view name : {"point", "nusselt", "analytic"}) {
    const auto method = make_form_factor_method(name, mesh);
    const FactorMatrix factors = assemble_factor_matrix(*method, mesh);
    const MethodRows rows(*method, mesh);
    FactorRow row;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows.read(i, row);
      ASSERT_EQ(row.columns.size(), factors.row_columns(i).size()) << name;
      for (std::size_t k = 0; k < row.columns.size(); ++k) {
        EXPECT_EQ(row.columns[k], factors.row_columns(i)[k]);
        EXPECT_NEAR(row.factors[k], factors.row_values(i)[k], 1e-15);
      }
    }
  }
}

/// Counts how often rows are asked for.
class CountingRows final : public FactorRowSource {
 public:
  explicit CountingRows(const FactorMatrix& matrix) : rows_(matrix) {}
  [[nodiscard]] std::size_t size() const override { return rows_.size(); }
  void read(std::size_t element, FactorRow& row) const override {
    ++reads;
    rows_.read(element, row);
  }
  mutable std::size_t reads = 0;

 private:
  MatrixRows rows_;
};

TEST(FactorRows, RowsAreKeptWhileThereIsRoom) {
  const PatchMesh mesh = room_with_plate(3);
  const FactorMatrix factors = assemble_factor_matrix(*make_form_factor_method("point", mesh), mesh);
  const CountingRows source(factors);
  for (const std::size_t room : {std::size_t{0}, factors.values.size() / 2, factors.values.size()}) {
    const KeptRows kept(source, room);
    std::size_t reads[2] = {};
    for (std::size_t& count : reads) {
      source.reads = 0;
      FactorRow row;
      for (std::size_t i = 0; i < kept.size(); ++i) {
        kept.read(i, row);
        const auto values = factors.row_values(i);
        EXPECT_EQ(row.factors, std::vector<double>(values.begin(), values.end()));
      }
      count = source.reads;
    }
    EXPECT_EQ(reads[0], kept.size());
    if (room == 0) {
      EXPECT_EQ(reads[1], kept.size());
    } else if (room == factors.values.size()) {
      EXPECT_EQ(reads[1], 0U);
    } else {
      EXPECT_GT(reads[1], 0U);
      EXPECT_LT(reads[1], kept.size());
    }
  }
}

// A surface of several patches radiates as one.
TEST(FactorRows, SurfacesOfSeveralPatchesAddUp) {
  PatchMeshBuilder builder(1, {}, [](std::uint32_t) { return std::string("face"); });
  const auto paint = builder.add_paint({{0.5}, {0}, {0}});
  const std::uint32_t walls = builder.add_surface({});
  const std::uint32_t floor = builder.add_surface({});
  const auto faces = room({1, 1, 1});
  for (std::uint32_t f = 1; f < 6; ++f) builder.add_face(faces[f], f, walls, paint);
  builder.add_face(faces[0], 0, floor, paint);
  const PatchMesh mesh = builder.finish().mesh;
  const auto method = make_form_factor_method("analytic", mesh);
  const MethodRows rows(*method, mesh);
  FactorRow row;
  rows.read(1, row);
  ASSERT_EQ(row.columns, std::vector<std::uint32_t>{0});
  EXPECT_NEAR(row.factors[0], 1, 1e-12);
  rows.read(0, row);
  ASSERT_EQ(row.columns, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_NEAR(row.factors[0], 0.8, 1e-12);
  EXPECT_NEAR(row.factors[1], 0.2, 1e-12);
}

// In a furnace the ambient term is exact from the first: every stage shown is the solution.
TEST(AmbientTerm, ShowsAFurnaceAsItWillBe) {
  const FactorMatrix factors = convex_factors(element_mesh(Dice(2).convex_cavity(20)));
  const RadiosityProblem problem = uniform_problem(factors.areas, 3, 0.75, 1);
  const auto ambient = ambient_radiosity(problem, problem.emission);
  for (const double a : ambient) EXPECT_NEAR(a, 4, 1e-12);
  const auto shown = with_ambient(problem, problem.emission, problem.emission);
  for (const double b : shown) EXPECT_NEAR(b, 4, 1e-12);
}

// In any closed scene what is shown reflects and emits the power of the solution's order: nearer than the stage itself.
TEST(AmbientTerm, BringsEarlyStagesNearer) {
  const FactorMatrix factors = convex_factors(element_mesh(room_elements({3, 4, 2}, 3)));
  const RadiosityProblem problem = random_problem(factors.areas, 3, 8);
  const auto exact = solve_direct(problem, factors);
  SolverOptions options;
  int stages = 0;
  const auto distance = [&](const std::vector<double>& values) {
    double sum = 0;
    for (std::size_t k = 0; k < values.size(); ++k) sum += std::abs(values[k] - exact.radiosity[k]);
    return sum;
  };
  options.on_stage = [&](const SolverStage& stage) {
    if (++stages > 3) return;
    EXPECT_LT(distance(with_ambient(problem, stage.radiosity, stage.unshot)), 0.5 * distance(stage.radiosity));
  };
  (void)solve_shooting(problem, factors, options);
  EXPECT_GE(stages, 3);
}

TEST(ShootingSolver, AStoppedSolutionIsPartial) {
  const FactorMatrix factors = convex_factors(element_mesh(room_elements({3, 4, 2}, 3)));
  const RadiosityProblem problem = random_problem(factors.areas, 3, 9);
  std::stop_source stop;
  SolverOptions options;
  options.progress.stop = stop.get_token();
  options.on_stage = [&](const SolverStage&) { stop.request_stop(); };
  const auto solution = solve_shooting(problem, factors, options);
  EXPECT_TRUE(solution.partial);
  EXPECT_EQ(solution.residuals.size(), std::size_t{1});
  EXPECT_NEAR(solution.energy.emitted, solution.energy.absorbed + solution.energy.escaped + solution.energy.unshot,
              1e-10 * solution.energy.emitted);
}

TEST(ShootingSolverThreaded, GivesTheSameBitsOnAnyThreadCount) {
  const PatchMesh mesh = room_with_plate(6);
  RadiosityProblem problem = random_problem(mesh.areas, 3, 10);
  FormFactorOptions rays;
  rays.rays = 256;
  const auto method = make_form_factor_method("ray-cast", mesh, rays);
  SolverOptions options;
  options.max_iterations = 100;
  std::vector<double> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const auto solution = solve_shooting(problem, MethodRows(*method, mesh), options);
    EXPECT_EQ(solution.iterations, std::size_t{100});
    if (first.empty()) first = solution.radiosity;
    EXPECT_EQ(solution.radiosity, first) << threads;
  }
}

}  // namespace
}  // namespace penumbra
