#include "penumbra/radiosity/solvers/ambient.h"

namespace penumbra {

std::vector<double> ambient_radiosity(const RadiosityProblem& problem, std::span<const double> unshot) {
  std::vector<double> ambient(problem.bands, 0.0);
  if (unshot.empty()) return ambient;
  for (std::size_t b = 0; b < problem.bands; ++b) {
    double area = 0, reflecting = 0, power = 0;
    for (std::size_t i = 0; i < problem.element_count(); ++i) {
      const std::size_t k = i * problem.bands + b;
      area += problem.areas[i];
      reflecting += problem.areas[i] * problem.reflectance[k];
      power += problem.areas[i] * unshot[k];
    }
    if (reflecting < area) ambient[b] = power / (area - reflecting);
  }
  return ambient;
}

std::vector<double> with_ambient(const RadiosityProblem& problem, std::span<const double> radiosity,
                                 std::span<const double> unshot) {
  const std::vector<double> ambient = ambient_radiosity(problem, unshot);
  std::vector<double> shown(radiosity.begin(), radiosity.end());
  for (std::size_t k = 0; k < shown.size(); ++k) shown[k] += problem.reflectance[k] * ambient[k % problem.bands];
  return shown;
}

}  // namespace penumbra
