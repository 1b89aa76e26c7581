#include "penumbra/scene/fluorescence.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "penumbra/scene/emission_spectrum.h"

namespace penumbra {

double Fluorescence::column_sum(std::size_t in) const {
  double sum = 0;
  for (std::size_t out = 0; out < bands(); ++out) sum += at(out, in);
  return sum;
}

double Fluorescence::largest_column_sum() const {
  double most = 0;
  for (std::size_t in = 0; in < bands(); ++in) most = std::max(most, column_sum(in));
  return most;
}

double Fluorescence::reflectance(double wavelength) const {
  const std::size_t band = band_of(edges, wavelength);
  return band < bands() ? at(band, band) : 0;
}

double Fluorescence::reradiation(double wavelength) const {
  const std::size_t out = band_of(edges, wavelength);
  if (out >= bands()) return 0;
  double sum = 0;
  for (std::size_t in = 0; in < out; ++in) sum += at(out, in) * width(in);
  return sum / width(out);
}

double Fluorescence::sample_absorbed(double wavelength, double u_band, double u_within) const {
  const std::size_t out = band_of(edges, wavelength);
  double left = u_band * reradiation(wavelength) * width(out);
  std::size_t chosen = 0;
  for (std::size_t in = 0; in < out; ++in) {
    const double share = at(out, in) * width(in);
    if (share == 0) continue;
    chosen = in;
    if (left < share) break;
    left -= share;
  }
  return edges[chosen] + u_within * width(chosen);
}

void validate(const Fluorescence& f) {
  validate_band_edges(f.edges);
  if (f.matrix.size() != f.bands() * f.bands()) {
    throw std::invalid_argument(
        fmt::format("needs a matrix of {0} x {0} numbers, one row for each band of light that "
                    "leaves, and holds {1}",
                    f.bands(), f.matrix.size()));
  }
  for (std::size_t out = 0; out < f.bands(); ++out) {
    for (std::size_t in = 0; in < f.bands(); ++in) {
      const double share = f.at(out, in);
      if (!(share >= 0 && share <= 1)) {
        throw std::invalid_argument(
            fmt::format("has {} in row {}, column {}; a share of light is 0 to 1", share, out + 1, in + 1));
      }
      if (out >= in || share == 0) continue;
      throw std::invalid_argument(fmt::format(
          "radiates at shorter wavelengths than it absorbs (row {}, column {}); what lies above the diagonal must be 0",
          out + 1, in + 1));
    }
  }
}

}  // namespace penumbra
