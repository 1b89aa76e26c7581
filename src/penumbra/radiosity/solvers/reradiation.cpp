#include "penumbra/radiosity/solvers/reradiation.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "penumbra/radiosity/solvers/solver.h"

namespace penumbra {
namespace {

constexpr double rounding = 1e-6;  // of shares that sum to 1

void check(const RadiosityProblem& problem, const Reradiation& r) {
  const std::size_t bands = problem.bands;
  if (!r.matrix_of.empty() && r.matrix_of.size() != problem.element_count()) {
    throw std::invalid_argument(fmt::format("fluorescence is given for {} elements, but the problem has {}",
                                            r.matrix_of.size(), problem.element_count()));
  }
  for (const auto& matrix : r.matrices) {
    if (matrix.size() != bands * bands) {
      throw std::invalid_argument(
          fmt::format("a fluorescence matrix holds {} numbers; {} bands need {}", matrix.size(), bands, bands * bands));
    }
    for (std::size_t out = 0; out < bands; ++out) {
      for (std::size_t in = 0; in < bands; ++in) {
        const double share = matrix[out * bands + in];
        if (!(share >= 0) || (out < in && share != 0)) {
          throw std::invalid_argument(fmt::format(
              "a fluorescence matrix has {} in row {}, column {}; light is absorbed and radiated at longer wavelengths "
              "only, so it should be {}",
              share, out + 1, in + 1, out < in ? "0" : "0 or more"));
        }
      }
    }
  }
  for (std::size_t i = 0; i < r.matrix_of.size(); ++i) {
    if (r.matrix_of[i] == Reradiation::none) continue;
    if (r.matrix_of[i] >= r.matrices.size()) {
      throw std::invalid_argument(fmt::format("element {} names a fluorescence matrix that is not there", i));
    }
    const auto& matrix = r.matrices[r.matrix_of[i]];
    for (std::size_t in = 0; in < bands; ++in) {
      double sum = problem.reflectance[i * bands + in];
      for (std::size_t out = in + 1; out < bands; ++out) sum += matrix[out * bands + in];
      if (sum > 1 + rounding) {
        throw std::invalid_argument(
            fmt::format("element {} passes on {:.4g} times the light of band {}; at most 1 keeps energy", i, sum, in));
      }
    }
  }
}

std::vector<double> band_of(const std::vector<double>& values, std::size_t bands, std::size_t band) {
  std::vector<double> one(values.size() / bands);
  for (std::size_t i = 0; i < one.size(); ++i) one[i] = values[i * bands + band];
  return one;
}

// The problem of one band alone, without what shorter ones excite.
RadiosityProblem problem_of(const RadiosityProblem& all, std::size_t band) {
  RadiosityProblem one;
  one.bands = 1;
  one.areas = all.areas;
  one.reflectance = band_of(all.reflectance, all.bands, band);
  one.emission = band_of(all.emission, all.bands, band);
  one.irradiance = band_of(all.irradiance, all.bands, band);
  if (!all.light_power.empty()) one.light_power = {all.light_power[band]};
  return one;
}

// Adds what the irradiance of shorter bands excites in `band`, W/m^2; returns the power, W.
double excite(const RadiosityProblem& all, const Reradiation& r, const std::vector<double>& irradiance,
              std::size_t band, RadiosityProblem& one) {
  double power = 0;
  for (std::size_t i = 0; i < r.matrix_of.size(); ++i) {
    if (r.matrix_of[i] == Reradiation::none) continue;
    const double* row = r.matrices[r.matrix_of[i]].data() + band * all.bands;
    double excited = 0;
    for (std::size_t in = 0; in < band; ++in) excited += row[in] * irradiance[i * all.bands + in];
    one.emission[i] += excited;
    power += all.areas[i] * excited;
  }
  return power;
}

void add(const RadiositySolution& one, std::size_t bands, std::size_t band, RadiositySolution& all) {
  for (std::size_t i = 0; i < one.radiosity.size(); ++i) {
    all.radiosity[i * bands + band] = one.radiosity[i];
    all.irradiance[i * bands + band] = one.irradiance[i];
  }
  all.residuals.push_back(one.residuals.empty() ? 0 : one.residuals.back());
  all.iterations += one.iterations;
  all.converged = all.converged && one.converged;
  all.partial = all.partial || one.partial;
  all.energy.emitted += one.energy.emitted;
  all.energy.absorbed += one.energy.absorbed;
  all.energy.escaped += one.energy.escaped;
  all.energy.unshot += one.energy.unshot;
  all.error_bound = std::max(all.error_bound, one.error_bound);
}

}  // namespace

RadiositySolution solve_with_reradiation(std::string_view solver, const RadiosityProblem& problem,
                                         const Reradiation& reradiation, const FactorMatrix& factors,
                                         const SolverOptions& options) {
  validate(problem);
  if (problem.specular) {
    throw std::invalid_argument("light by way of mirrors and glass is followed in red, green and blue only");
  }
  check(problem, reradiation);
  SolverOptions own = options;
  own.on_stage = nullptr;
  RadiositySolution all;
  all.radiosity.resize(problem.element_count() * problem.bands);
  all.irradiance.resize(all.radiosity.size());
  all.converged = true;
  all.error_bound = 0;
  for (std::size_t band = 0; band < problem.bands; ++band) {
    RadiosityProblem one = problem_of(problem, band);
    const double excited = excite(problem, reradiation, all.irradiance, band, one);
    add(solve_radiosity(solver, one, factors, own), problem.bands, band, all);
    all.energy.emitted -= excited;
    all.energy.absorbed -= excited;
    if (all.partial) break;
  }
  all.unshot_fraction = all.energy.emitted > 0 ? all.energy.unshot / all.energy.emitted : 0;
  return all;
}

}  // namespace penumbra
