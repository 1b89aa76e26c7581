#include "penumbra/tracing/shading/light_emission.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "penumbra/math/sampling.h"

namespace penumbra {
namespace {

using std::numbers::pi;

bool comes_from_afar(const Scene& scene, const LightSampler::Source& source) {
  if (source.kind == LightSampler::Kind::environment) return true;
  return source.kind == LightSampler::Kind::punctual &&
         std::holds_alternative<DirectionalLight>(scene.lights[source.index].kind);
}

constexpr double even_share = 0.25;  // of the particles, for all lights alike

}  // namespace

LightEmission::LightEmission(const Scene& scene, const LightSampler& lights) : scene_(&scene), lights_(&lights) {
  const Bounds bounds = scene.bounds();
  centre_ = bounds.empty() ? Vec3d(0) : bounds.centre();
  radius_ = std::max(1e-3, bounds.diagonal() / 2) * (1 + 1e-6);
  const bool endless = std::any_of(scene.shapes.begin(), scene.shapes.end(),
                                   [](const ShapeObject& o) { return std::holds_alternative<Plane>(o.shape); });
  double sum = 0;
  chances_.push_back(0);
  for (std::size_t i = 0; i < lights.light_count(); ++i) {
    const LightSampler::Source& source = lights.light(i);
    if (endless && comes_from_afar(scene, source)) {
      throw std::invalid_argument(
          "a sun or a sky over an endless plane sends out no countable light; give the plane an end, or trace from the "
          "eye");
    }
    if (source.kind == LightSampler::Kind::punctual) {
      const auto* point = std::get_if<PointLight>(&scene.lights[source.index].kind);
      if (point != nullptr && !point->inverse_square) {
        throw std::invalid_argument(
            "a point light that does not fade with distance sends out no countable light; trace from the eye");
      }
    }
    sum += source.power;
    chances_.push_back(sum);
  }
  if (!(sum > 0)) {
    chances_.clear();
    return;
  }
  std::size_t lit = 0;
  for (std::size_t i = 0; i < lights.light_count(); ++i) lit += lights.light(i).power > 0 ? 1 : 0;
  double before = 0, even = 0;
  for (std::size_t i = 0; i < lights.light_count(); ++i) {
    even += lights.light(i).power > 0 ? even_share / static_cast<double>(lit) : 0;
    before += lights.light(i).power / sum;
    chances_[i + 1] = (1 - even_share) * before + even;
  }
}

std::optional<LightEmission::Origin> LightEmission::sample_origin(double u_light, const Vec2d& u) const {
  const auto above = std::upper_bound(chances_.begin() + 1, chances_.end() - 1, u_light);
  Origin origin;
  origin.light = static_cast<std::size_t>(above - chances_.begin()) - 1;
  origin.inverse_chance = 1 / (chances_[origin.light + 1] - chances_[origin.light]);
  const LightSampler::Source& source = lights_->light(origin.light);
  if (source.kind == LightSampler::Kind::punctual) {
    if (const auto* far = std::get_if<DirectionalLight>(&scene_->lights[source.index].kind)) {
      // Drawn by the solid angle of its disk, as LightSampler does.
      const double cosine = std::cos(far->angular_radius);
      origin.direction = Frame(-far->direction).to_world(sample_cone(u, cosine));
      origin.inverse_chance *= 2 / (1 + cosine);
    }
    return origin;
  }
  if (source.kind == LightSampler::Kind::environment) {
    const EnvironmentMap::Sample sky = lights_->environment().sample(u);
    if (!(sky.pdf > 0)) return std::nullopt;
    origin.direction = sky.direction;
    origin.radiance = lights_->environment().radiance(sky.direction);
    origin.inverse_chance /= sky.pdf;
    return origin;
  }
  const auto place = lights_->sample_point(origin.light, u);
  if (!place) return std::nullopt;
  origin.point = place->point;
  origin.radiance = emission_at(*scene_, place->point);
  if (is_black(origin.radiance)) return std::nullopt;
  origin.inverse_chance /= place->density;
  return origin;
}

LightEmission::Particle LightEmission::sample_direction(const Origin& origin, double u_side, const Vec2d& u) const {
  if (origin.point) return from_lamp(origin, u_side, u);
  const LightSampler::Source& source = lights_->light(origin.light);
  const auto weight = static_cast<float>(origin.inverse_chance);
  if (source.kind == LightSampler::Kind::environment) {
    return from_afar(-origin.direction, weight * origin.radiance, u);
  }
  const auto& kind = scene_->lights[source.index].kind;
  if (const auto* far = std::get_if<DirectionalLight>(&kind)) {
    return from_afar(-origin.direction, weight * far->irradiance, u);
  }
  Particle particle;
  if (const auto* point = std::get_if<PointLight>(&kind)) {
    particle.ray = {.origin = point->position, .direction = sample_sphere(u)};
    particle.power = static_cast<float>(4 * pi) * weight * point->intensity;
    if (point->web) {
      const PhotometricWeb& web = scene_->webs[point->web->web];
      particle.power *= static_cast<float>(candela_towards(web, *point->web, particle.ray.direction));
    }
    particle.range = std::isfinite(point->range) ? point->range : 0;
    return particle;
  }
  const auto& spot = std::get<SpotLight>(kind);
  const double cosine = std::cos(spot.outer_angle);
  particle.ray = {.origin = spot.position, .direction = Frame(spot.direction).to_world(sample_cone(u, cosine))};
  particle.power =
      static_cast<float>(2 * pi * (1 - cosine) * spot_window(spot, particle.ray.direction)) * weight * spot.intensity;
  particle.range = std::isfinite(spot.range) ? spot.range : 0;
  return particle;
}

// By the cosine from the side that shines, of two one by chance.
LightEmission::Particle LightEmission::from_lamp(const Origin& origin, double u_side, const Vec2d& u) const {
  const SurfacePoint& point = *origin.point;
  const bool both = scene_->materials[point.material].double_sided;
  const bool back = both && u_side < 0.5;
  const Frame frame(back ? -point.geometric_normal : point.geometric_normal);
  Particle particle;
  particle.ray = leave(point, frame.to_world(sample_cosine_hemisphere(u)));
  particle.power = static_cast<float>(origin.inverse_chance * pi * (both ? 2 : 1)) * origin.radiance;
  return particle;
}

// Through a disk that faces the light and hides the scene's sphere.
LightEmission::Particle LightEmission::from_afar(const Vec3d& way, const Rgb& irradiance, const Vec2d& u) const {
  const Frame frame(way);
  const Vec2d d = radius_ * sample_disk(u);
  Particle particle;
  particle.ray = {.origin = centre_ - radius_ * way + d.x * frame.tangent + d.y * frame.bitangent, .direction = way};
  particle.power = static_cast<float>(pi * radius_ * radius_) * irradiance;
  return particle;
}

}  // namespace penumbra
