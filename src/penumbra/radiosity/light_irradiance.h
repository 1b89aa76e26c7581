#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// What one light without a body brings to elements for each unit of its strength, band by band: light adds up, so a
/// scene with other colours and intensities needs no new rays.
struct LightIrradiance {
  static constexpr std::size_t environment = ~std::size_t{0};

  std::size_t light = environment;  ///< number in Scene::lights, or the environment
  std::vector<double> unit;         ///< [element * 3 + band], W/m^2 at strength 1; empty: nothing arrives
  Vec3d power{0};                   ///< W at strength 1: flux of points and spots; of others what reaches the elements
};

/// The strength of a light: intensity (W/sr), irradiance (W/m^2) of a far light, radiance (W/(m^2 sr)) of the
/// environment, before its picture; 0 for ambient light.
[[nodiscard]] Vec3d light_strength(const Scene& scene, std::size_t light);

/// The flux of a light without a body, W; none for those that count as emitting what reaches the scene: far lights, and
/// points without falloff.
[[nodiscard]] std::optional<Vec3d> light_flux(const Scene& scene, const Light& light);

/// The sum of what the lights bring at their present strengths, [element * 3 + band], W/m^2; empty without lights.
[[nodiscard]] std::vector<double> irradiance_of(const Scene& scene, const std::vector<LightIrradiance>& lights);
/// The sum of their power, [band], W.
[[nodiscard]] std::vector<double> power_of(const Scene& scene, const std::vector<LightIrradiance>& lights);

}  // namespace penumbra
