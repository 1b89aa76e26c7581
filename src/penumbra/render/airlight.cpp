#include "penumbra/render/airlight.h"

#include <algorithm>
#include <cmath>

#include "penumbra/math/sampling.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/tracing/shading/phase_function.h"

namespace penumbra {
namespace {

// Shadow rays along a ray to each light, for single scattering.
constexpr int distances_a_light = 4;

SurfacePoint point_in_air(const Vec3d& position) {
  SurfacePoint point;
  point.position = position;
  return point;
}

}  // namespace

Airlight::Airlight(const LightSampler& lights, const Shadow& shadow) : lights_(&lights), shadow_(&shadow) {
  for (std::size_t light = 0; light < lights.light_count(); ++light) {
    if (const auto place = lights.place(light)) places_.push_back(*place);
  }
}

Rgb Airlight::transmittance(const Way& way, double t) const {
  Ray part = way.ray;
  part.t_max = t;
  return shadow_->media().transmittance(way.around, part, way.bands);
}

// In proportion to the transmittance when it falls evenly.
ExponentialDistances Airlight::by_transmittance(const Way& way, const Media::Interval& interval) const {
  const double length = interval.to - interval.from;
  if (!std::isfinite(length)) {
    const Vec3d sigma(shadow_->media().extinction(way.around, way.ray.at(interval.from), way.bands));
    return {(sigma.x + sigma.y + sigma.z) / 3, interval};
  }
  const Vec3d depth = shadow_->media().optical_depth(way.around, way.ray, way.bands);
  return {(depth.x + depth.y + depth.z) / (3 * length), interval};
}

Rgb Airlight::scattered_once(const Way& way, int depth, PixelSampler& sampler, RayCounts& rays) const {
  const auto interval = shadow_->media().scattering_interval(way.around, way.ray);
  if (!interval) return Rgb(0);
  Way inside = way;
  if (way.around) inside.interior.note_inside(*way.around);
  const ExponentialDistances even = by_transmittance(way, *interval);
  Rgb sum(0);
  for (std::size_t light = 0; light < lights_->light_count(); ++light) {
    const auto place = lights_->place(light);
    const double shift = sampler.next_1d();
    Rgb from_this(0);
    for (int i = 0; i < distances_a_light; ++i) {
      const double u = (i + shift) / distances_a_light;
      double t = 0, pdf = 0;
      if (place) {
        const EquiangularDistances around_it(way.ray, *place, *interval);
        t = around_it.sample(u);
        pdf = around_it.pdf(t);
      } else {
        t = even.sample(u);
        pdf = even.pdf(t);
      }
      if (!(pdf > 0)) continue;
      count(rays, RayPurpose::shadow, depth);
      from_this += from_light(inside, light, t, sampler.next_2d()) * transmittance(way, t) / static_cast<float>(pdf);
    }
    sum += from_this / static_cast<float>(distances_a_light);
  }
  if (!is_black(lights_->ambient())) sum += ambient(way, even, sampler);
  return sum;
}

// What one light brings to a point of the way, scattered towards its start, 1/m of it.
Rgb Airlight::from_light(const Way& way, std::size_t light, double t, const Vec2d& u) const {
  SurfacePoint at = point_in_air(way.ray.at(t));
  at.time = way.ray.time;
  const auto s = lights_->sample_light(light, at, u);
  if (!s) return Rgb(0);
  Rgb scattered(0);
  const double mu = dot(way.ray.direction, s->direction);
  for (const Media::Lobe& lobe : shadow_->media().lobes(way.around, at.position, way.bands)) {
    scattered += lobe.scattering * static_cast<float>(HenyeyGreenstein(lobe.asymmetry).value(mu));
  }
  if (is_black(scattered)) return Rgb(0);
  return scattered * s->weight(way.bands) * shadow_->transmittance(s->shadow_ray, way.interior, way.bands);
}

Rgb Airlight::ambient(const Way& way, const ExponentialDistances& distances, PixelSampler& sampler) const {
  const double t = distances.sample(sampler.next_1d());
  Rgb scattering(0);
  for (const Media::Lobe& lobe : shadow_->media().lobes(way.around, way.ray.at(t), way.bands))
    scattering += lobe.scattering;
  return way.bands.emission(lights_->ambient()) * scattering * transmittance(way, t) /
         static_cast<float>(distances.pdf(t));
}

std::optional<Airlight::Anchor> Airlight::choose_anchor(const Way& way, double u) const {
  if (places_.empty()) return std::nullopt;
  const auto interval = shadow_->media().scattering_interval(way.around, way.ray);
  if (!interval) return std::nullopt;
  const auto chosen = std::min(static_cast<std::size_t>(u * static_cast<double>(places_.size())), places_.size() - 1);
  return Anchor{EquiangularDistances(way.ray, places_[chosen], *interval), *interval};
}

// The density (1/m) with which a flight collides at t.
double Airlight::flight_pdf(const Way& way, double t, const Rgb& throughput) const {
  const Rgb collided = transmittance(way, t) * shadow_->media().extinction(way.around, way.ray.at(t), way.bands);
  const float sum = throughput.x + throughput.y + throughput.z;
  return sum > 0 ? dot(throughput, collided) / sum : (collided.x + collided.y + collided.z) / 3;
}

Rgb Airlight::by_angles(const Way& way, const Anchor& anchor, const Rgb& throughput, int depth, PixelSampler& sampler,
                        RayCounts& rays) const {
  const double t = anchor.distances.sample(sampler.next_1d());
  const double either = anchor.distances.pdf(t) + flight_pdf(way, t, throughput);
  const Media::Lobes lobes = shadow_->media().lobes(way.around, way.ray.at(t), way.bands);
  const Rgb light = from_chosen_light(way, lobes, t, depth, sampler, rays);
  return either > 0 ? light * transmittance(way, t) / static_cast<float>(either) : Rgb(0);
}

Rgb Airlight::at_collision(const Way& way, const Media::Flight& flight, const std::optional<Anchor>& anchor,
                           const Rgb& throughput, int depth, PixelSampler& sampler, RayCounts& rays) const {
  double share = 1;
  if (anchor) {
    const double flown = flight_pdf(way, flight.distance, throughput);
    share = flown / (flown + anchor->distances.pdf(flight.distance));
  }
  Media::Lobes lobes;
  lobes.lobe[lobes.count++] = {Rgb(1), shadow_->media().medium(flight.medium).asymmetry};
  return from_chosen_light(way, lobes, flight.distance, depth, sampler, rays) * static_cast<float>(share);
}

Rgb Airlight::from_chosen_light(const Way& way, const Media::Lobes& lobes, double t, int depth, PixelSampler& sampler,
                                RayCounts& rays) const {
  const double u_light = sampler.next_1d();
  const auto s = lights_->sample(point_in_air(way.ray.at(t)), u_light, sampler.next_2d());
  if (!s) return Rgb(0);
  Rgb scattered(0);
  const double mu = dot(way.ray.direction, s->direction);
  for (const Media::Lobe& lobe : lobes) {
    const double phase = HenyeyGreenstein(lobe.asymmetry).value(mu);
    // The other way to find this light is a direction drawn by the phase function.
    const double share = s->pdf > 0 ? power_heuristic(s->pdf, phase) : 1;
    scattered += lobe.scattering * static_cast<float>(phase * share);
  }
  if (is_black(scattered)) return Rgb(0);
  count(rays, RayPurpose::shadow, depth);
  return scattered * s->weight(way.bands) * shadow_->transmittance(s->shadow_ray, way.interior, way.bands);
}

}  // namespace penumbra
