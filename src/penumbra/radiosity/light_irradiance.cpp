#include "penumbra/radiosity/light_irradiance.h"

#include <variant>

namespace penumbra {

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
