#include "penumbra/render/direct_light.h"

#include <cmath>

#include "penumbra/render/ray_tally.h"

namespace penumbra {
namespace {

// From how many triangles on a light has parts far enough apart to choose among, and how many candidates are weighed.
constexpr std::size_t many_parts = 5;
constexpr int candidates = 8;

}  // namespace

Rgb DirectLight::reflected(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo, double roughness_limit,
                           int depth, PixelSampler& sampler, RayCounts& rays) const {
  Rgb sum(0);
  for (std::size_t light = 0; light < lights_.light_count(); ++light) {
    const auto met = meet(point, bsdf, wo, roughness_limit, light, sampler);
    if (!met) continue;
    count(rays, RayPurpose::shadow, depth);
    sum += met->radiance;
  }
  return sum;
}

std::optional<DirectLight::Meeting> DirectLight::meet(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo,
                                                      double roughness_limit, std::size_t light,
                                                      PixelSampler& sampler) const {
  const Vec3d& n = bsdf.shading_normal();
  const Receiver to{point, bsdf, wo, dot(n, wo) < 0 ? -n : n, roughness_limit};
  const Candidate c = from_light(to, light, sampler);
  if (is_black(c.radiance)) return std::nullopt;
  return Meeting{c.shadow_ray, c.radiance * shadow_.transmittance(c.shadow_ray)};
}

DirectLight::Candidate DirectLight::from_light(const Receiver& to, std::size_t light, PixelSampler& sampler) const {
  const LightSampler::Source& source = lights_.light(light);
  if (source.kind == LightSampler::Kind::environment && !lights_.environment().has_picture()) {
    return from_sky(to, sampler);
  }
  if (at_middles_ && lights_.has_middle(light)) {
    const auto s = lights_.sample_middle(light, to.point);
    return s ? unhindered(to, *s) : Candidate{};
  }
  if (source.triangles.size() >= many_parts) return from_many_parts(to, light, sampler);
  const auto s = lights_.sample_light(light, to.point, sampler.next_2d(), to.facing);
  return s ? unhindered(to, *s) : Candidate{};
}

DirectLight::Candidate DirectLight::unhindered(const Receiver& to, const LightSample& light) const {
  const Rgb f = to.bsdf.evaluate_unsplit(to.wo, light.direction, to.roughness_limit);
  const auto cosine = static_cast<float>(std::abs(dot(to.facing, light.direction)));
  return {light.shadow_ray, f * cosine * light.weight()};
}

// Resampled importance sampling (Talbot, Cline & Egbert 2005): of several points one is kept, with a chance in
// proportion to the light that it would bring; dividing by that chance keeps the mean.
DirectLight::Candidate DirectLight::from_many_parts(const Receiver& to, std::size_t light,
                                                    PixelSampler& sampler) const {
  const Vec2d start = sampler.next_2d();
  double choice = sampler.next_1d();
  Candidate kept;
  double total = 0;
  double weight = 0;
  for (int i = 0; i < candidates; ++i) {
    // Stratified over the light's parts.
    const Vec2d u((i + start.x) / candidates, std::fmod(start.y + i * 0.6180339887498949, 1.0));
    const auto s = lights_.sample_light(light, to.point, u, to.facing);
    if (!s) continue;
    const Candidate c = unhindered(to, *s);
    const double w = luminance(c.radiance);
    if (!(w > 0)) continue;
    total += w;
    // One random number decides every time: its part beyond the decision is uniform again.
    const double chance = w / total;
    if (choice < chance) {
      kept = c;
      weight = w;
      choice /= chance;
    } else {
      choice = (choice - chance) / (1 - chance);
    }
  }
  if (!(weight > 0)) return {};
  kept.radiance *= static_cast<float>(total / (weight * candidates));
  return kept;
}

// A sky of one colour: only the surface says which directions matter.
DirectLight::Candidate DirectLight::from_sky(const Receiver& to, PixelSampler& sampler) const {
  const double u_lobe = sampler.next_1d();
  const auto s = to.bsdf.sample(to.wo, u_lobe, sampler.next_2d());
  if (!s || s->ideal) return {};
  const double density = to.bsdf.pdf(to.wo, s->direction);
  if (!(density > 0)) return {};
  const Rgb f = to.bsdf.evaluate_unsplit(to.wo, s->direction, to.roughness_limit);
  const auto cosine = static_cast<float>(std::abs(dot(to.facing, s->direction)) / density);
  return {leave(to.point, s->direction), f * cosine * lights_.environment().radiance(s->direction)};
}

}  // namespace penumbra
