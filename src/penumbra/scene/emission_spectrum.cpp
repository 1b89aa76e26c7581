#include "penumbra/scene/emission_spectrum.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "penumbra/math/cie_colour.h"

namespace penumbra {

std::size_t band_of(const std::vector<double>& edges, double wavelength) {
  const auto above = std::upper_bound(edges.begin(), edges.end(), wavelength);
  const auto bands = edges.size() - 1;
  return above == edges.begin() ? bands : std::min(static_cast<std::size_t>(above - edges.begin()) - 1, bands);
}

void validate_band_edges(const std::vector<double>& edges) {
  const bool ascend = std::adjacent_find(edges.begin(), edges.end(), std::greater_equal<>()) == edges.end();
  if (edges.size() < 2 || !ascend || !(edges.front() > 0) || !std::isfinite(edges.back())) {
    throw std::invalid_argument("needs two or more edges of bands in nm, above 0 and ascending");
  }
}

double EmissionSpectrum::at(double wavelength) const {
  const std::size_t band = band_of(edges, wavelength);
  return band < radiance.size() ? radiance[band] / (edges[band + 1] - edges[band]) : 0;
}

Rgb EmissionSpectrum::colour() const {
  constexpr int points = 64;  // a band, midpoint rule
  Vec3d sum(0);
  for (std::size_t band = 0; band < radiance.size(); ++band) {
    const double width = edges[band + 1] - edges[band];
    for (int i = 0; i < points; ++i) {
      sum += radiance[band] / points * rec709_matching(edges[band] + (i + 0.5) / points * width);
    }
  }
  return Rgb(glm::max(sum, Vec3d(0)));
}

void validate(const EmissionSpectrum& spectrum) {
  validate_band_edges(spectrum.edges);
  if (spectrum.radiance.size() + 1 != spectrum.edges.size()) {
    throw std::invalid_argument("needs one radiance for each band, one fewer than edges");
  }
  const bool good = std::all_of(spectrum.radiance.begin(), spectrum.radiance.end(),
                                [](double r) { return r >= 0 && std::isfinite(r); });
  if (!good) throw std::invalid_argument("has a radiance that is negative or not finite");
}

}  // namespace penumbra
