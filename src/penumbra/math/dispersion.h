#pragma once

#include <array>
#include <variant>

namespace penumbra {

/// n^2 = 1 + sum of b l^2 / (l^2 - c), l in micrometres in air (Sellmeier 1871): how glass catalogues state it.
struct Sellmeier {
  std::array<double, 3> b{};
  std::array<double, 3> c{};  ///< micrometres^2
};

/// n = a + b / l^2 + c / l^4, l in micrometres (Cauchy 1830).
struct Cauchy {
  double a = 1.5;
  double b = 0;  ///< micrometres^2
  double c = 0;  ///< micrometres^4
};

/// How an index of refraction depends on wavelength.
using Dispersion = std::variant<Sellmeier, Cauchy>;

// Spectral lines by which glass is described, nm: F and C of hydrogen, d of helium.
inline constexpr double line_f = 486.1327;
inline constexpr double line_d = 587.5618;
inline constexpr double line_c = 656.2725;

/// Index of refraction at a wavelength in nm; at least 1. Not a number inside an absorption band (l^2 < c).
[[nodiscard]] double refractive_index(const Dispersion& dispersion, double wavelength);

/// Abbe's number V_d = (n_d - 1) / (n_F - n_C); infinite when the index does not vary.
[[nodiscard]] double abbe_number(const Dispersion& dispersion);

/// Cauchy's formula with two terms that has index `n_d` at the d line and Abbe's number `abbe`: what
/// KHR_materials_dispersion asks for. @pre abbe > 0.
[[nodiscard]] Cauchy cauchy_of_abbe(double n_d, double abbe);

}  // namespace penumbra
