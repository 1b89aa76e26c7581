#pragma once

#include "penumbra/math/spectrum.h"
#include "penumbra/scene/light.h"
#include "penumbra/scene/texture.h"

namespace penumbra {

/// Where the sun stands and how clear the air is.
struct DaylightOptions {
  double elevation = 0.7853981633974483;  ///< rad above the horizon, 0 to pi/2
  double azimuth = 0;                     ///< rad, clockwise seen from above, from north (-Z); east is +X
  double turbidity = 3;                   ///< 2 (very clear) to 10 (hazy): haze and air over air alone
  double ground_albedo = 0.2;             ///< of the ground below the horizon, 0..1
  int width = 1024;                       ///< texels around the horizon; half as many from zenith to nadir
};

/// A cloudless sky, for Environment and Light.
struct Daylight {
  TextureImage sky;      ///< latitude-longitude, radiance in W/(m^2 sr); see Environment
  DirectionalLight sun;  ///< a disk of half a degree
};

/// The sky of Preetham, Shirley & Smits, "A Practical Analytic Model for Daylight" (SIGGRAPH 1999): Perez' luminance
/// and chromaticity by direction (their appendix A.2), divided by 683 lm/W. The sun's disk (0.53 degrees) has the
/// spectral radiance outside the atmosphere times what Rayleigh scattering, aerosol, ozone, mixed gases and water
/// vapour leave (their appendix A.1). Below the horizon lies an even ground, lit by both. Throws std::invalid_argument
/// for options out of range.
[[nodiscard]] Daylight make_daylight(const DaylightOptions& options);

/// Radiance of that sky from one direction, W/(m^2 sr). @param direction unit; at or above the horizon (y >= 0).
[[nodiscard]] Rgb sky_radiance(const DaylightOptions& options, const Vec3d& direction);

/// Unit vector towards the sun.
[[nodiscard]] Vec3d sun_direction(const DaylightOptions& options);

}  // namespace penumbra
