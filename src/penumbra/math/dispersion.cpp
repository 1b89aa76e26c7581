#include "penumbra/math/dispersion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

double square_in_micrometres(double wavelength) { return wavelength * wavelength * 1e-6; }

double index_of(const Sellmeier& glass, double l2) {
  double n2 = 1;
  for (std::size_t i = 0; i < glass.b.size(); ++i) n2 += glass.b[i] * l2 / (l2 - glass.c[i]);
  return std::sqrt(n2);
}

double index_of(const Cauchy& glass, double l2) { return glass.a + glass.b / l2 + glass.c / (l2 * l2); }

}  // namespace

double refractive_index(const Dispersion& dispersion, double wavelength) {
  const double l2 = square_in_micrometres(wavelength);
  const double n = std::visit([&](const auto& glass) { return index_of(glass, l2); }, dispersion);
  return std::isnan(n) ? n : std::max(1.0, n);
}

double abbe_number(const Dispersion& dispersion) {
  const double spread = refractive_index(dispersion, line_f) - refractive_index(dispersion, line_c);
  if (spread == 0) return std::numeric_limits<double>::infinity();
  return (refractive_index(dispersion, line_d) - 1) / spread;
}

Cauchy cauchy_of_abbe(double n_d, double abbe) {
  const double f2 = square_in_micrometres(line_f), c2 = square_in_micrometres(line_c);
  const double b = (n_d - 1) / abbe / (1 / f2 - 1 / c2);
  return {.a = n_d - b / square_in_micrometres(line_d), .b = b, .c = 0};
}

}  // namespace penumbra
