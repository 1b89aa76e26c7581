#include "penumbra/scene/luminaire.h"

#include <cmath>
#include <utility>

namespace penumbra {
namespace {

constexpr float lumens_per_watt = 683;

// Some way across `nadir`, towards -Z where that can be.
Vec3d across(const Vec3d& nadir) {
  const Vec3d wanted = std::abs(nadir.z) < 0.9 ? Vec3d(0, 0, -1) : Vec3d(0, -1, 0);
  return normalize(wanted - dot(wanted, nadir) * nadir);
}

}  // namespace

bool can_wear_web(const Light& light) {
  return std::holds_alternative<PointLight>(light.kind) || std::holds_alternative<SpotLight>(light.kind);
}

void wear_web(Scene& scene, std::size_t light, PhotometricWeb web) {
  const auto* spot = std::get_if<SpotLight>(&scene.lights[light].kind);
  const Vec3d nadir = spot != nullptr ? spot->direction : Vec3d(0, -1, 0);
  wear_web(scene, light, std::move(web), nadir, across(nadir));
}

void wear_web(Scene& scene, std::size_t light, PhotometricWeb web, const Vec3d& nadir, const Vec3d& zero) {
  auto& kind = scene.lights[light].kind;
  const auto* spot = std::get_if<SpotLight>(&kind);
  PointLight worn = spot != nullptr
                        ? PointLight{.position = spot->position, .intensity = spot->intensity, .range = spot->range}
                        : std::get<PointLight>(kind);
  const float strength = luminance(worn.intensity);
  worn.intensity = (strength > 0 ? worn.intensity / strength : Rgb(1)) / lumens_per_watt;
  worn.intensity *= static_cast<float>(tilt_factor(web, nadir));
  worn.inverse_square = true;
  worn.web = WebPlacement{.web = static_cast<std::uint32_t>(scene.webs.size()), .nadir = nadir, .zero = zero};
  scene.webs.push_back(std::move(web));
  kind = worn;
}

}  // namespace penumbra
