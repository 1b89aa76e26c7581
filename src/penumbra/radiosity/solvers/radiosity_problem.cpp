#include "penumbra/radiosity/solvers/radiosity_problem.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace penumbra {
namespace {

void check(const std::vector<double>& values, std::size_t count, double most, std::string_view what,
           std::size_t bands) {
  if (values.size() != count) {
    throw std::invalid_argument(
        fmt::format("the radiosity problem has {} values of {} where {} are needed", values.size(), what, count));
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (values[k] >= 0 && values[k] <= most) continue;
    throw std::invalid_argument(fmt::format("the {} of element {} is {}; it should be {}", what, k / bands, values[k],
                                            most == 1 ? "from 0 to 1" : "finite and not negative"));
  }
}

}  // namespace

RadiosityProblem make_radiosity_problem(const PatchMesh& mesh) {
  RadiosityProblem problem;
  problem.bands = mesh.bands;
  for (const PatchSurface& surface : mesh.surfaces) problem.areas.push_back(surface.area);
  problem.reflectance = mesh.reflectance;
  problem.emission = mesh.emission;
  return problem;
}

std::vector<double> irradiance_of_lights(const RadiosityProblem& problem) {
  if (problem.specular_irradiance.empty()) return problem.irradiance;
  std::vector<double> sum = problem.specular_irradiance;
  for (std::size_t k = 0; k < problem.irradiance.size(); ++k) sum[k] += problem.irradiance[k];
  return sum;
}

void validate(const RadiosityProblem& problem) {
  if (problem.bands == 0) throw std::invalid_argument("the radiosity problem has no bands; it needs at least one");
  constexpr double largest = std::numeric_limits<double>::max();
  const std::size_t values = problem.element_count() * problem.bands;
  check(problem.areas, problem.element_count(), largest, "area", 1);
  for (std::size_t i = 0; i < problem.element_count(); ++i) {
    if (problem.areas[i] > 0) continue;
    throw std::invalid_argument(fmt::format("element {} has no area; leave it out", i));
  }
  check(problem.reflectance, values, 1, "reflectance", problem.bands);
  check(problem.emission, values, largest, "emission", problem.bands);
  if (!problem.irradiance.empty()) check(problem.irradiance, values, largest, "irradiance", problem.bands);
  if (!problem.specular_irradiance.empty()) {
    check(problem.specular_irradiance, values, largest, "specular irradiance", problem.bands);
  }
  if (problem.specular &&
      (problem.bands != SpecularTransport::bands || problem.specular->rows() != problem.element_count())) {
    throw std::invalid_argument("light by way of mirrors and glass was computed for other elements than the problem's");
  }
  if (!problem.light_power.empty()) check(problem.light_power, problem.bands, largest, "light power", problem.bands);
}

}  // namespace penumbra
