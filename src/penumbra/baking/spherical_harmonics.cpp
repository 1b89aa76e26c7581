#include "penumbra/baking/spherical_harmonics.h"

#include <cmath>
#include <numbers>

namespace penumbra {

using std::numbers::pi;

std::array<double, 9> spherical_harmonics(const Vec3d& d) {
  static const double band0 = std::sqrt(1 / (4 * pi)), band1 = std::sqrt(3 / (4 * pi)),
                      band2 = std::sqrt(15 / (4 * pi)), zonal2 = std::sqrt(5 / (16 * pi)),
                      tesseral2 = std::sqrt(15 / (16 * pi));
  return {band0,
          band1 * d.y,
          band1 * d.z,
          band1 * d.x,
          band2 * d.x * d.y,
          band2 * d.y * d.z,
          zonal2 * (3 * d.z * d.z - 1),
          band2 * d.x * d.z,
          tesseral2 * (d.x * d.x - d.y * d.y)};
}

Rgb irradiance_from(const std::array<Rgb, 9>& radiance, const Vec3d& normal) {
  const std::array<double, 9> y = spherical_harmonics(normal);
  Rgb sum(0);
  for (std::size_t k = 0; k < 9; ++k) {
    const double band = k == 0 ? pi : k < 4 ? 2 * pi / 3 : pi / 4;
    sum += static_cast<float>(band * y[k]) * radiance[k];
  }
  return sum;
}

}  // namespace penumbra
