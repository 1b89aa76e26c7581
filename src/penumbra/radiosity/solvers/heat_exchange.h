#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/direct.h"

namespace penumbra {

/// The constant of Stefan and Boltzmann, W/(m^2 K^4) (CODATA 2018).
inline constexpr double stefan_boltzmann = 5.670374419e-8;

/// A grey, diffuse, opaque surface. Exactly one of temperature and heat flux is given.
struct HeatSurface {
  std::string name;                   ///< for messages
  double emissivity = 1;              ///< 0..1, equal to the absorptivity; 0 needs a temperature or a heat flux of 0
  std::optional<double> temperature;  ///< K, 0 or more
  /// Net heat per area that the surface gives to the enclosure, W/m^2: negative where it takes heat, 0 where it is
  /// insulated ('re-radiating').
  std::optional<double> heat_flux;
};

struct HeatExchangeOptions {
  double surroundings_temperature = 0;  ///< K, of the black surroundings that rows see which sum to less than 1
  double tolerance = 1e-10;        ///< of the residual over the largest source, where the system is solved by iteration
  std::size_t max_iterations = 0;  ///< 0: a safe limit
  std::size_t most_direct = most_direct_elements;  ///< surfaces that are solved for by LU
  Progress progress;
};

/// What a system of surfaces comes to. Arrays hold a value a surface.
struct HeatExchange {
  std::vector<double> temperature;  ///< K; NaN for a perfect reflector (emissivity 0) of no given temperature
  std::vector<double> radiosity;    ///< J, W/m^2
  std::vector<double> irradiance;   ///< H, W/m^2
  std::vector<double> heat_flux;    ///< q, W/m^2, net, given to the enclosure
  std::vector<double> heat;         ///< A q, W
  /// The balance, W, each from its own terms: supplied + removed = to_surroundings.
  double supplied = 0;         ///< sum of the positive heats
  double removed = 0;          ///< sum of the negative ones
  double to_surroundings = 0;  ///< what leaves past all surfaces less what comes from there
  double imbalance = 0;        ///< supplied + removed - to_surroundings
  std::size_t iterations = 0;
  double residual = 0;  ///< largest, over the largest source
  bool converged = false;
  bool partial = false;
};

/// Net radiation method for grey diffuse surfaces (Hottel 1954; Gebhart; Modest, Radiative Heat Transfer, ch. 5):
///
///     J_i = eps_i sigma T_i^4 + (1 - eps_i) H_i   where the temperature is given,
///     J_i = q_i + H_i                             where the heat flux is given,
///     H_i = sum_j F_ij J_j + (1 - sum_j F_ij) sigma T_surroundings^4,
///
/// then q_i = eps_i (sigma T_i^4 - H_i), or sigma T_i^4 = H_i + q_i / eps_i. The system has the form of the radiosity
/// equation, with reflectance 1 and emission q where the flux is given; sources and sinks of heat are solved for as two
/// bands. Up to `most_direct` surfaces by LU, above by Gauss-Seidel.
/// Throws std::invalid_argument, naming the surface: for values out of range, both or none given, a heat flux that no
/// temperature can give (more heat taken than arrives), a flux of a perfect reflector, or fluxes alone in an enclosure
/// that nothing leaves (its temperature could be any).
[[nodiscard]] HeatExchange solve_heat_exchange(const std::vector<HeatSurface>& surfaces, const FactorMatrix& factors,
                                               const HeatExchangeOptions& options = {});

}  // namespace penumbra
