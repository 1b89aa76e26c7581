#include "penumbra/render/direct_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/render/ray_tally.h"

namespace penumbra {
namespace {

// From how many triangles on a light has parts far enough apart to choose among, and how many candidates are weighed.
constexpr std::size_t many_parts = 5;
constexpr int candidates = 8;

// Points of a lamp that is seen whole whose light is weighed without a ray.
constexpr int unchecked_points = 8;

}  // namespace

DirectLight::DirectLight(const RayTracer& tracer, const RenderOptions& options)
    : DirectLight(tracer, !options.opaque_shadows,
                  options.samples_per_pixel == 1 && options.shadow_samples <= 1 && !options.exact_shadows) {
  most_rays_ = std::max(1, options.shadow_samples);
  everywhere_ = options.shadow_samples_everywhere;
  exact_ = options.exact_shadows && shadow_.media().none();  // a clipped lamp knows no way through fog
  if (exact_ || is_selective()) flat_lamps_.emplace(tracer.scene(), lights_, !options.opaque_shadows, exact_);
}

DirectLight::Receiver DirectLight::receiver(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo,
                                            double roughness_limit, const Bands& bands) const {
  const Vec3d& n = bsdf.shading_normal();
  return {point, bsdf, wo, dot(n, wo) < 0 ? -n : n, roughness_limit, bands};
}

Rgb DirectLight::reflected(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo, double roughness_limit,
                           int depth, PixelSampler& sampler, RayCounts& rays, const Bands& bands) const {
  const Receiver to = receiver(point, bsdf, wo, roughness_limit, bands);
  Rgb sum(0);
  for (std::size_t light = 0; light < lights_.light_count(); ++light) {
    if (const auto exact = exactly(to, light, depth, sampler, rays)) {
      sum += *exact;
    } else {
      sum += by_rays(to, light, depth, sampler, rays);
    }
  }
  return sum;
}

// One ray, or the mean of many where a shadow may end. Where the first pass saw all of a lamp, one ray says what is
// missing of the light that the lamp would bring unhindered: a control variate, and no noise from it where nothing is.
Rgb DirectLight::by_rays(const Receiver& to, std::size_t light, int depth, PixelSampler& sampler,
                         RayCounts& rays) const {
  const auto send = [&](PixelSampler& numbers) {
    const Candidate c = from_light(to, light, numbers);
    if (is_black(c.radiance)) return Shaded{};
    penumbra::count(rays, RayPurpose::shadow, depth);
    return Shaded{c.radiance, shadow_.transmittance(c.shadow_ray, {}, to.bands)};
  };
  const bool judged = !boundaries_.empty();
  const bool boundary = judged && boundaries_.crosses(sampler.x(), sampler.y(), light, depth > 0);
  if (most_rays_ > 1 && has_body(light) && (everywhere_ || boundary)) {
    const PixelSampler::Draws draws = sampler.next_draws(static_cast<std::uint32_t>(most_rays_));
    Rgb sum(0);
    for (int i = 0; i < most_rays_; ++i) {
      PixelSampler numbers = draws(static_cast<std::uint32_t>(i));
      const Shaded s = send(numbers);
      sum += s.open * s.passed;
    }
    return sum / static_cast<float>(most_rays_);
  }
  const Shaded s = send(sampler);
  if (!judged || !has_body(light) || !boundaries_.is_free(sampler.x(), sampler.y(), light, depth > 0)) {
    return s.open * s.passed;
  }
  return open_light(to, light, sampler) - s.open * (Rgb(1) - s.passed);
}

bool DirectLight::has_body(std::size_t light) const {
  return lights_.light(light).kind != LightSampler::Kind::punctual;
}

namespace {

PolygonShadows::Receiver for_polygons(const SurfacePoint& point, const Vec3d& wo, const Vec3d& facing) {
  const Vec3d& n = point.geometric_normal;
  return {point.position, largest_component(point.error), dot(n, wo) < 0 ? -n : n, facing};
}

}  // namespace

Rgb DirectLight::flat_radiance(const Receiver& to, std::size_t light) const {
  const EmissionSpectrum* spectrum = lights_.spectrum(light);
  if (spectrum && to.bands.spectral()) return spectrum_in(*spectrum, to.bands);
  return to.bands.emission(flat_lamps_->radiance(light));
}

// What a light would bring with nothing in between: known of flat lamps on Lambertian surfaces, else by several points
// of it that need no rays.
Rgb DirectLight::open_light(const Receiver& to, std::size_t light, PixelSampler& sampler) const {
  if (flat_lamps_ && flat_lamps_->has(light) && to.bsdf.is_lambertian()) {
    const double form = flat_lamps_->open_factor(light, for_polygons(to.point, to.wo, to.facing));
    return to.bsdf.diffuse_albedo(to.wo) * flat_radiance(to, light) * static_cast<float>(form);
  }
  const PixelSampler::Draws draws = sampler.next_draws(unchecked_points);
  Rgb sum(0);
  for (int i = 0; i < unchecked_points; ++i) {
    PixelSampler numbers = draws(static_cast<std::uint32_t>(i));
    sum += from_light(to, light, numbers).radiance;
  }
  return sum / static_cast<float>(unchecked_points);
}

// The lamp clipped by what stands before it. Gloss on top is left to rays: they bring what the matt part does not.
std::optional<Rgb> DirectLight::exactly(const Receiver& to, std::size_t light, int depth, PixelSampler& sampler,
                                        RayCounts& rays) const {
  if (!exact_ || !flat_lamps_->has(light)) return std::nullopt;
  const auto form = flat_lamps_->visible_factor(light, for_polygons(to.point, to.wo, to.facing));
  if (!form) return std::nullopt;
  const Rgb matt = to.bsdf.diffuse_albedo(to.wo) * flat_radiance(to, light) * static_cast<float>(*form);
  if (to.bsdf.is_lambertian()) return matt;
  const Candidate c = from_light(to, light, sampler);
  const Rgb gloss = c.radiance - to.bsdf.diffuse_albedo(to.wo) * std::numbers::inv_pi_v<float> * c.irradiance;
  if (is_black(gloss)) return matt;
  penumbra::count(rays, RayPurpose::shadow, depth);
  return matt + gloss * shadow_.transmittance(c.shadow_ray, {}, to.bands);
}

std::optional<DirectLight::Meeting> DirectLight::meet(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo,
                                                      double roughness_limit, std::size_t light, PixelSampler& sampler,
                                                      const Bands& bands) const {
  const Candidate c = from_light(receiver(point, bsdf, wo, roughness_limit, bands), light, sampler);
  if (is_black(c.radiance)) return std::nullopt;
  const Rgb passed = shadow_.transmittance(c.shadow_ray, {}, bands);
  return Meeting{c.shadow_ray, c.radiance * passed, passed};
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
  const double cosine = dot(to.facing, light.direction);
  const Rgb weight = static_cast<float>(std::abs(cosine)) * light.weight(to.bands);
  // Irradiance of the side that is seen: above its shading normal's horizon and its own.
  const Vec3d& n = to.point.geometric_normal;
  const bool on_side = cosine > 0 && dot(n, light.direction) * dot(n, to.wo) > 0;
  return {light.shadow_ray, f * weight, on_side ? weight : Rgb(0)};
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
    const double w = to.bands.spectral() ? max_component(c.radiance) : luminance(c.radiance);
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
  return {leave(to.point, s->direction), f * cosine * to.bands.emission(lights_.environment().radiance(s->direction)),
          Rgb(0)};
}

}  // namespace penumbra
