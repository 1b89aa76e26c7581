#pragma once

#include <vector>

#include "penumbra/math/spectrum.h"

namespace penumbra {

/// Light by bands of wavelength, such as a violet lamp's, which no RGB colour can say: even within each band, none
/// outside.
struct EmissionSpectrum {
  std::vector<double> edges;     ///< nm, ascending, one more than there are bands
  std::vector<double> radiance;  ///< of each band as a whole, W/(m^2 sr), >= 0

  /// Spectral radiance, W/(m^2 sr nm).
  [[nodiscard]] double at(double wavelength) const;
  /// Its colour, linear Rec. 709; what lies outside red, green and blue's gamut is cut off at 0.
  [[nodiscard]] Rgb colour() const;
};

/// Throws std::invalid_argument that says what is wrong: a sentence that goes on from "its emission spectrum".
void validate(const EmissionSpectrum& spectrum);

/// The band of `edges` that holds a wavelength in nm; the number of bands when none does.
[[nodiscard]] std::size_t band_of(const std::vector<double>& edges, double wavelength);

/// Throws std::invalid_argument when they are not at least two, finite, above 0 and ascending.
void validate_band_edges(const std::vector<double>& edges);

}  // namespace penumbra
