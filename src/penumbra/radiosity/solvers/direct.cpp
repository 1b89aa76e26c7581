#include "penumbra/radiosity/solvers/direct.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "penumbra/radiosity/solvers/radiosity_equation.h"

namespace penumbra {
namespace {

using Factorisation = Eigen::PartialPivLU<Eigen::MatrixXd>;

Eigen::VectorXd band_of(const std::vector<double>& values, std::size_t bands, std::size_t band) {
  Eigen::VectorXd one(static_cast<Eigen::Index>(values.size() / bands));
  for (Eigen::Index i = 0; i < one.size(); ++i) one[i] = values[static_cast<std::size_t>(i) * bands + band];
  return one;
}

/// @param band whose light by way of mirrors and glass counts.
Eigen::MatrixXd system_matrix(const FactorMatrix& factors, const SpecularTransport* specular, std::size_t band,
                              const Eigen::VectorXd& reflectance) {
  const Eigen::Index n = reflectance.size();
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const auto columns = factors.row_columns(row);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      m(i, static_cast<Eigen::Index>(columns[k])) -= reflectance[i] * factors.row_values(row)[k];
    }
    if (specular == nullptr) continue;
    for (std::uint64_t k = specular->offsets[row]; k < specular->offsets[row + 1]; ++k) {
      m(i, static_cast<Eigen::Index>(specular->columns[k])) -=
          reflectance[i] * static_cast<double>(specular->values[SpecularTransport::bands * k + band]);
    }
  }
  return m;
}

}  // namespace

void refuse_what_direct_does_not_take(std::size_t elements) {
  if (elements <= most_direct_elements) return;
  throw std::invalid_argument(
      fmt::format("the direct solver takes at most {} elements, not {}; use gauss-seidel or shooting",
                  most_direct_elements, elements));
}

RadiositySolution solve_direct(const RadiosityProblem& problem, const FactorMatrix& factors,
                               const SolverOptions& options) {
  const RadiosityEquation equation(problem, factors);
  refuse_what_direct_does_not_take(problem.element_count());
  const std::size_t bands = problem.bands;
  std::vector<double> radiosity = equation.source();
  std::optional<Factorisation> lu;
  Eigen::VectorXd factorised;
  bool stopped = false;
  for (std::size_t band = 0; band < bands && problem.element_count() > 0; ++band) {
    options.progress.tell("solve", static_cast<double>(band) / static_cast<double>(bands));
    stopped = options.progress.stop_requested();
    if (stopped) break;
    const Eigen::VectorXd reflectance = band_of(problem.reflectance, bands, band);
    if (!lu || problem.specular || reflectance != factorised) {
      lu.emplace(system_matrix(factors, problem.specular.get(), band, reflectance));
      factorised = reflectance;
    }
    const Eigen::VectorXd solved = lu->solve(band_of(equation.source(), bands, band));
    for (Eigen::Index i = 0; i < solved.size(); ++i) radiosity[static_cast<std::size_t>(i) * bands + band] = solved[i];
  }
  RadiosityEquation::State state;
  equation.evaluate(radiosity, state);
  const double residual = equation.relative(state.largest_residual);
  const bool finite = std::all_of(radiosity.begin(), radiosity.end(), [](double b) { return std::isfinite(b); });
  RadiositySolution solution = equation.describe(std::move(radiosity), std::move(state));
  solution.residuals = {residual};
  solution.iterations = 1;
  solution.partial = stopped;
  solution.converged = !stopped && finite && residual <= std::max(options.tolerance, 1e-9);
  if (options.on_stage) options.on_stage({1, solution.radiosity, {}, residual});
  options.progress.tell("solve", 1);
  return solution;
}

}  // namespace penumbra
