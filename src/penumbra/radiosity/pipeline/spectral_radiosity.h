#pragma once

#include <cstddef>
#include <vector>

#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/radiosity/solvers/reradiation.h"

namespace penumbra {

/// A scene's radiosity problem over bands of wavelength instead of red, green and blue, with its dyes.
///
/// Colours become spectra by `uplift_basis`, as in spectral rendering; within a band light has the shape of D65. The
/// edges are those of the visible range, of all emission spectra and of all fluorescence, cut evenly in between.
struct SpectralProblem {
  std::vector<double> edges;  ///< nm, ascending, one more than bands
  RadiosityProblem problem;   ///< its bands are these; W/m^2 a band
  Reradiation reradiation;

  [[nodiscard]] std::size_t bands() const { return problem.bands; }
};

/// The problem of a setup made from `scene` with elements for red, green and blue.
/// @param widest_band nm, above 0. Throws std::invalid_argument when the setup has light by way of mirrors and glass.
[[nodiscard]] SpectralProblem make_spectral_problem(const Scene& scene, const RadiositySetup& setup,
                                                    double widest_band = 10);

/// Values over bands, [element * bands + band], W/m^2, as linear Rec. 709, [element * 3 + band]; colours that red,
/// green and blue cannot mix have negative parts.
[[nodiscard]] std::vector<double> to_rgb(const std::vector<double>& edges, const std::vector<double>& values);

/// A scene solved over bands of wavelength.
struct SpectralRadiosity {
  std::vector<double> edges;  ///< nm
  RadiositySolution bands;    ///< over the bands
  SceneRadiosity rgb;         ///< its radiosity and irradiance as linear Rec. 709, its energy that of all bands
};

/// Solves it band by band (see solve_with_reradiation) with the setup's solver. Throws std::invalid_argument when the
/// setup keeps no matrix of form factors, and as above.
[[nodiscard]] SpectralRadiosity solve_spectral(const Scene& scene, const RadiositySetup& setup,
                                               const SolverOptions& options);

}  // namespace penumbra
