#include "penumbra/radiosity/light_irradiance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "penumbra/scene/photometric_web.h"

namespace penumbra {
namespace {

using std::numbers::pi;

/// A flux that a light of unit intensity on its axis sends through its cone, sr: the squared ramp of
/// KHR_lights_punctual integrated over the sphere.
double cone_integral(const SpotLight& spot) {
  const double outer = std::cos(spot.outer_angle);
  const double ramp = std::max(0.001, std::cos(spot.inner_angle) - outer);
  // Over the cosine: ramp^2 rises from 0 to 1 over `ramp`, then stays; the cosine ends at 1.
  const double rising = std::min(ramp, 1 - outer), share = rising / ramp;
  return 2 * pi * (rising * share * share / 3 + std::max(0.0, 1 - outer - ramp));
}

}  // namespace

Vec3d light_strength(const Scene& scene, std::size_t light) {
  if (light == LightIrradiance::environment) {
    return scene.environment ? Vec3d(scene.environment->radiance) : Vec3d(0);
  }
  const auto& kind = scene.lights[light].kind;
  if (const auto* point = std::get_if<PointLight>(&kind)) return Vec3d(point->intensity);
  if (const auto* spot = std::get_if<SpotLight>(&kind)) return Vec3d(spot->intensity);
  if (const auto* far = std::get_if<DirectionalLight>(&kind)) return Vec3d(far->irradiance);
  return Vec3d(0);
}

std::optional<Vec3d> light_flux(const Scene& scene, const Light& light) {
  if (const auto* point = std::get_if<PointLight>(&light.kind)) {
    if (point->web) return luminous_flux(scene.webs[point->web->web]) * Vec3d(point->intensity);
    if (point->inverse_square) return 4 * pi * Vec3d(point->intensity);
  } else if (const auto* spot = std::get_if<SpotLight>(&light.kind)) {
    return cone_integral(*spot) * Vec3d(spot->intensity);
  }
  return std::nullopt;
}

std::vector<double> irradiance_of(const Scene& scene, const std::vector<LightIrradiance>& lights) {
  std::vector<double> sum;
  for (const LightIrradiance& l : lights) {
    const Vec3d strength = light_strength(scene, l.light);
    sum.resize(std::max(sum.size(), l.unit.size()), 0.0);
    for (std::size_t k = 0; k < l.unit.size(); ++k) sum[k] += strength[static_cast<int>(k % 3)] * l.unit[k];
  }
  return sum;
}

std::vector<double> power_of(const Scene& scene, const std::vector<LightIrradiance>& lights) {
  std::vector<double> sum(3, 0.0);
  for (const LightIrradiance& l : lights) {
    const Vec3d strength = light_strength(scene, l.light);
    for (std::size_t b = 0; b < 3; ++b) sum[b] += strength[static_cast<int>(b)] * l.power[static_cast<int>(b)];
  }
  return sum;
}

}  // namespace penumbra
