#include "penumbra/radiosity/solvers/radiosity_equation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/solvers/energy_balance.h"

namespace penumbra {
namespace {

constexpr std::size_t rows_a_task = 64;

// The number of bands is known to the compiler where it is usual.
template <std::size_t Bands>
void gather_rows(const FactorMatrix& factors, std::size_t first, std::size_t last, const double* radiosity,
                 double* gathered) {
  for (std::size_t i = first; i < last; ++i, gathered += Bands) {
    const auto columns = factors.row_columns(i);
    const auto values = factors.row_values(i);
    double sum[Bands] = {};
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const double* sent = radiosity + columns[k] * Bands;
      for (std::size_t b = 0; b < Bands; ++b) sum[b] += values[k] * sent[b];
    }
    std::copy_n(sum, Bands, gathered);
  }
}

void gather_rows(const FactorMatrix& factors, std::size_t bands, std::size_t first, std::size_t last,
                 const double* radiosity, double* gathered) {
  for (std::size_t i = first; i < last; ++i, gathered += bands) {
    const auto columns = factors.row_columns(i);
    const auto values = factors.row_values(i);
    std::fill_n(gathered, bands, 0.0);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const double* sent = radiosity + columns[k] * bands;
      for (std::size_t b = 0; b < bands; ++b) gathered[b] += values[k] * sent[b];
    }
  }
}

}  // namespace

RadiosityEquation::RadiosityEquation(const RadiosityProblem& problem, const FactorMatrix& factors)
    : problem_(problem), factors_(factors), source_(problem.emission) {
  validate(problem);
  lights_ = irradiance_of_lights(problem);
  const std::size_t n = problem.element_count(), bands = problem.bands;
  if (factors.rows() != n) {
    throw std::invalid_argument(fmt::format(
        "the form factors are of {} elements, the problem of {}; compute them for the same mesh", factors.rows(), n));
  }
  emitted_ = emitted_power(problem);
  self_factors_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double sum = factors.row_sum(i);
    Vec3d turned(0);
    if (problem.specular) turned = problem.specular->row_sum(i);
    self_factors_[i] = factors.at(i, i);
    for (std::size_t k = i * bands; k < (i + 1) * bands; ++k) {
      if (!lights_.empty()) source_[k] += problem.reflectance[k] * lights_[k];
      largest_source_ = std::max(largest_source_, source_[k]);
      contraction_ = std::max(contraction_, problem.reflectance[k] * (sum + turned[static_cast<int>(k % 3)]));
    }
  }
}

double RadiosityEquation::diagonal(std::size_t value) const {
  const double d = 1 - problem_.reflectance[value] * self_factors_[value / problem_.bands];
  return d > 0 ? d : 1;
}

void RadiosityEquation::gather(std::size_t first, std::size_t last, std::span<const double> radiosity,
                               std::span<double> gathered) const {
  switch (problem_.bands) {
    case 1:
      gather_rows<1>(factors_, first, last, radiosity.data(), gathered.data());
      break;
    case 3:
      gather_rows<3>(factors_, first, last, radiosity.data(), gathered.data());
      break;
    case 4:
      gather_rows<4>(factors_, first, last, radiosity.data(), gathered.data());
      break;
    default:
      gather_rows(factors_, problem_.bands, first, last, radiosity.data(), gathered.data());
  }
  if (problem_.specular) problem_.specular->gather(first, last, radiosity, gathered);
}

void RadiosityEquation::evaluate(std::span<const double> radiosity, State& state) const {
  const std::size_t n = problem_.element_count(), bands = problem_.bands;
  state.irradiance.resize(n * bands);
  state.residual.resize(n * bands);
  parallel_for(n, rows_a_task, [&](std::size_t first, std::size_t last) {
    gather(first, last, radiosity, std::span(state.irradiance).subspan(first * bands, (last - first) * bands));
    for (std::size_t k = first * bands; k < last * bands; ++k) {
      if (!lights_.empty()) state.irradiance[k] += lights_[k];
      state.residual[k] = problem_.emission[k] + problem_.reflectance[k] * state.irradiance[k] - radiosity[k];
    }
  });
  state.largest_residual = 0;
  state.unshot = 0;
  for (std::size_t k = 0; k < state.residual.size(); ++k) {
    const double residual = std::abs(state.residual[k]);
    state.largest_residual = std::max(state.largest_residual, residual);
    state.unshot += problem_.areas[k / bands] * residual;
  }
}

double RadiosityEquation::unshot_fraction(const State& state) const {
  return emitted_ > 0 ? state.unshot / emitted_ : 0;
}

double RadiosityEquation::relative(double residual) const {
  return largest_source_ > 0 ? residual / largest_source_ : residual;
}

RadiositySolution RadiosityEquation::describe(std::vector<double> radiosity, State state) const {
  RadiositySolution solution;
  solution.energy = energy_balance(problem_, factors_, radiosity, state.irradiance, state.residual);
  solution.unshot_fraction = solution.energy.emitted > 0 ? solution.energy.unshot / solution.energy.emitted : 0;
  if (contraction_ < 1) solution.error_bound = state.largest_residual / (1 - contraction_);
  solution.radiosity = std::move(radiosity);
  solution.irradiance = std::move(state.irradiance);
  return solution;
}

}  // namespace penumbra
