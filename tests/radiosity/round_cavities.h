#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "radiosity/polygon_makers.h"

namespace penumbra::test {

/// Part of a sphere about the origin, cut into rings of planar facets, fronts inwards: from polar angle `first` to
/// `last` (rad, 0 is up).
inline std::vector<Polygon> sphere_facets(double radius, double first, double last, int rings, int around) {
  std::vector<Polygon> facets;
  const auto clean = [&](double r) { return r < 1e-12 * radius ? 0 : r; };
  for (int k = 0; k < rings; ++k) {
    const double upper = first + (last - first) * k / rings, lower = first + (last - first) * (k + 1) / rings;
    const auto band = outward_band(clean(radius * std::sin(lower)), radius * std::cos(lower),
                                   clean(radius * std::sin(upper)), radius * std::cos(upper), around);
    for (const Polygon& side : reversed(band)) facets.push_back(side);
  }
  return facets;
}

/// Exchange (m^2) between coaxial disks of radius r and s at distance h (Hottel; catalogue C-41).
inline double disk_exchange(double r, double s, double h) {
  const double a = r * r + s * s + h * h;
  return 0.5 * std::numbers::pi * (a - std::sqrt(std::max(0.0, a * a - 4 * r * r * s * s)));
}

}  // namespace penumbra::test
