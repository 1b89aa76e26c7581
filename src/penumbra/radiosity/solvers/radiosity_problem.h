#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/specular_transport.h"

namespace penumbra {

/// The data of the discrete radiosity equation (Goral, Torrance, Greenberg & Battaile 1984, eq. 8), for every band:
///
///     B_i = E_i + rho_i (H_i + sum_j F_ij B_j)
///
/// B radiosity, E emission, H the irradiance from lights that are no elements (points, spots, sun, sky), all W/m^2; rho
/// the diffuse reflectance; F_ij the form factor from i to j. The form factors are given to the solvers apart.
/// Arrays are [element * bands + band].
struct RadiosityProblem {
  std::size_t bands = 3;
  std::vector<double> areas;        ///< m^2, per element, > 0
  std::vector<double> reflectance;  ///< 0..1
  std::vector<double> emission;     ///< E, >= 0
  std::vector<double> irradiance;   ///< H, >= 0; empty when every light is an element
  /// What the other lights emit, per band, W: points their flux, sun and sky what reaches the scene. Empty: the sum of
  /// A_i H_i.
  std::vector<double> light_power;

  /// Light by way of mirrors and glass, H_i += sum_j X_ij B_j; none: there is none, or it is left out. With it an
  /// element that only mirrors or transmits has reflectance 0: what it passes on arrives by this matrix.
  std::shared_ptr<const SpecularTransport> specular;
  std::vector<double> specular_irradiance;  ///< what the other lights bring that way, W/m^2; empty: nothing

  [[nodiscard]] std::size_t element_count() const { return areas.size(); }
};

/// An element for each surface of the mesh, with its reflectance and emission.
[[nodiscard]] RadiosityProblem make_radiosity_problem(const PatchMesh& mesh);

/// H: irradiance of the other lights, straight and by way of mirrors and glass; empty without.
[[nodiscard]] std::vector<double> irradiance_of_lights(const RadiosityProblem& problem);

/// Throws std::invalid_argument when an array has the wrong length or a value is out of range.
void validate(const RadiosityProblem& problem);

}  // namespace penumbra
