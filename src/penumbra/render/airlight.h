#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "penumbra/render/distance_sampling.h"
#include "penumbra/render/pixel_sampler.h"
#include "penumbra/render/render.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "penumbra/tracing/shading/media.h"
#include "penumbra/tracing/shading/shadow.h"

namespace penumbra {

/// Light that the media along a ray scatter straight from the lights towards the eye.
///
/// Single scattering: L = integral of T(0, t) sigma_s(t) p(mu) L_light T_light dt along the ray. Distances are sampled
/// by equal angles around lights that have a place (Kulla & Fajardo 2012), by the transmittance for far ones.
class Airlight {
 public:
  /// Both must outlive it.
  Airlight(const LightSampler& lights, const Shadow& shadow);

  /// A ray on its way through media.
  struct Way {
    Ray ray;  ///< t_max is its length, m; infinite when it leaves the scene
    Surroundings around;
    Interior interior;
    Bands bands{};  ///< of the light that is followed
  };

  /// Radiance by one scattering from every light, a few shadow rays to each, and ambient light once scattered.
  [[nodiscard]] Rgb scattered_once(const Way& way, int depth, PixelSampler& sampler, RayCounts& rays) const;

  // Of paths that are scattered many times (see Media::fly), the light at a collision, found in two ways that are
  // joined by the balance heuristic over distance.

  /// A light, and distances by equal angles around it.
  struct Anchor {
    EquiangularDistances distances;
    Media::Interval interval;
  };
  /// One of the lights that have a place, all alike; none when there is none.
  [[nodiscard]] std::optional<Anchor> choose_anchor(const Way& way, double u) const;
  /// Light by one shadow ray from a distance drawn by equal angles, times the transmittance to it.
  /// @param throughput by which the flight along the same way chooses its band.
  [[nodiscard]] Rgb by_angles(const Way& way, const Anchor& anchor, const Rgb& throughput, int depth,
                              PixelSampler& sampler, RayCounts& rays) const;
  /// Light by one shadow ray from the collision of a flight. @param anchor of by_angles on the same way, if there is.
  [[nodiscard]] Rgb at_collision(const Way& way, const Media::Flight& flight, const std::optional<Anchor>& anchor,
                                 const Rgb& throughput, int depth, PixelSampler& sampler, RayCounts& rays) const;

 private:
  [[nodiscard]] Rgb from_light(const Way& way, std::size_t light, double t, const Vec2d& u) const;
  [[nodiscard]] Rgb from_chosen_light(const Way& way, const Media::Lobes& lobes, double t, int depth,
                                      PixelSampler& sampler, RayCounts& rays) const;
  [[nodiscard]] Rgb ambient(const Way& way, const ExponentialDistances& distances, PixelSampler& sampler) const;
  [[nodiscard]] Rgb transmittance(const Way& way, double t) const;
  [[nodiscard]] ExponentialDistances by_transmittance(const Way& way, const Media::Interval& interval) const;
  [[nodiscard]] double flight_pdf(const Way& way, double t, const Rgb& throughput) const;

  const LightSampler* lights_;
  const Shadow* shadow_;
  std::vector<Vec3d> places_;  ///< of lights that have one
};

}  // namespace penumbra
