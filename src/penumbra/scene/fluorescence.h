#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace penumbra {

/// A matt surface's bispectral reradiation matrix (Donaldson, "Spectrophotometry of Fluorescent Pigments", 1954): of
/// the radiant power that arrives in band `in`, the share that leaves in band `out`.
///
/// The diagonal is ordinary reflectance: light stays at its wavelength. Below it light is absorbed and radiated again,
/// evenly over the band `out`. Bands ascend in wavelength, so what lies above the diagonal would be radiated at shorter
/// wavelengths than were absorbed: it must be 0 (Stokes 1852).
struct Fluorescence {
  std::vector<double> edges;   ///< nm, ascending, one more than there are bands
  std::vector<double> matrix;  ///< [out * bands + in], 0..1

  [[nodiscard]] std::size_t bands() const { return edges.empty() ? 0 : edges.size() - 1; }
  [[nodiscard]] double at(std::size_t out, std::size_t in) const { return matrix[out * bands() + in]; }
  [[nodiscard]] double width(std::size_t band) const { return edges[band + 1] - edges[band]; }
  /// What a band's light is passed on in all, 0..1 where energy is kept.
  [[nodiscard]] double column_sum(std::size_t in) const;
  [[nodiscard]] double largest_column_sum() const;

  /// Ordinary reflectance at a wavelength in nm; none outside the bands.
  [[nodiscard]] double reflectance(double wavelength) const;
  /// Spectral radiance radiated again at a wavelength, over that of light of the same spectral radiance in all shorter
  /// bands: the sum over `in` of D[out][in] width(in) / width(out). What a path that goes backwards is multiplied by.
  [[nodiscard]] double reradiation(double wavelength) const;
  /// A wavelength, nm, at which light that is radiated again at `wavelength` was absorbed: its density is D[out][in]
  /// width(in), even within each band. @param u uniform: which band, and where in it. @pre reradiation(wavelength) > 0.
  [[nodiscard]] double sample_absorbed(double wavelength, double u_band, double u_within) const;
};

/// Throws std::invalid_argument that says what is wrong, as a sentence that goes on from "its fluorescence": a matrix
/// of another size than the bands, an entry outside 0..1, or one that radiates at shorter wavelengths than it absorbs.
void validate(const Fluorescence& fluorescence);

}  // namespace penumbra
