#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// Luminous intensity of a luminaire by direction, as a goniophotometer measures it (type C of IES LM-63).
///
/// The vertical angle counts from the nadir of the luminaire (0) to its zenith (180), the horizontal angle around that
/// axis.
struct PhotometricWeb {
  std::string name;
  std::vector<double> vertical;    ///< degrees, ascending, within 0..180
  std::vector<double> horizontal;  ///< degrees, ascending, 0 first; ending at 0, 90, 180 or 360 as the symmetry is
  std::vector<double> candela;     ///< cd, >= 0; at [horizontal * vertical.size() + vertical]
  /// What is left of the lamp's light when the luminaire hangs otherwise than it was measured; both empty: all of it.
  std::vector<double> tilt{};          ///< degrees of its nadir from the vertical, ascending
  std::vector<double> tilt_factors{};  ///< >= 0, one for each
};

/// How a web is turned in the world.
struct WebPlacement {
  std::uint32_t web = 0;  ///< index into Scene::webs
  Vec3d nadir{0, -1, 0};  ///< unit, the way of vertical angle 0
  Vec3d zero{0, 0, -1};   ///< unit, perpendicular to the nadir: the way of horizontal angle 0 at vertical angle 90
};

/// Intensity at a vertical and a horizontal angle, degrees: bilinear between the measured angles, 0 beyond the
/// vertical ones, mirrored or repeated as the horizontal ones say.
[[nodiscard]] double candela_at(const PhotometricWeb& web, double vertical, double horizontal);

/// The same towards a world direction. @param way unit, away from the luminaire.
[[nodiscard]] double candela_towards(const PhotometricWeb& web, const WebPlacement& placed, const Vec3d& way);

/// The factor of the tilt of a luminaire whose nadir points along `nadir` (unit; the world's is -y): linear between the
/// angles of the web, its first or last factor beyond; 1 without.
[[nodiscard]] double tilt_factor(const PhotometricWeb& web, const Vec3d& nadir);

/// Luminous flux, lm: the integral of the intensity over the sphere, exact for the interpolated web in its vertical
/// angle (closed form between measured angles) and its horizontal one.
[[nodiscard]] double luminous_flux(const PhotometricWeb& web);

}  // namespace penumbra
