#pragma once

#include <array>
#include <span>

#include "penumbra/math/spectrum.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Real spherical harmonics of bands 0 to 2, orthonormal over the sphere, in the order (l, m) = (0,0), (1,-1), (1,0),
/// (1,1), (2,-2), (2,-1), (2,0), (2,1), (2,2), without the Condon-Shortley sign: of band 1 they are y, z and x, each
/// times sqrt(3 / (4 pi)). (Ramamoorthi & Hanrahan, "An Efficient Representation for Irradiance Environment Maps",
/// SIGGRAPH 2001, eq. 3.) @param direction unit.
[[nodiscard]] std::array<double, 9> spherical_harmonics(const Vec3d& direction);

/// Irradiance, W/m^2, on a surface with that unit normal, from the coefficients of radiance: each band times pi, 2/3 pi
/// and pi/4 (the same, eq. 8 and 10).
[[nodiscard]] Rgb irradiance_from(const std::array<Rgb, 9>& radiance, const Vec3d& normal);

}  // namespace penumbra
