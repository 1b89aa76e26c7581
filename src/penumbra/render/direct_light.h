#pragma once

#include <optional>

#include "penumbra/math/bands.h"
#include "penumbra/radiosity/meshing/polygon_shadows.h"
#include "penumbra/render/pixel_sampler.h"
#include "penumbra/render/render.h"
#include "penumbra/render/shadow_boundaries.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "penumbra/tracing/shading/shadow.h"

namespace penumbra {

/// Light that reaches a surface straight from every light of the scene: Appel's and Whitted's shadow rays ('shadow
/// feelers'), one to each light, many where its shadow may end, or none where the lamp is clipped exactly.
class DirectLight {
 public:
  /// @param through_glass whether transparent surfaces let shadow rays pass, see Shadow.
  /// @param at_middles whether lights are met at their middle where they have one: sharp shadows without noise.
  DirectLight(const RayTracer& tracer, bool through_glass, bool at_middles)
      : lights_(tracer.scene()), shadow_(tracer, through_glass), at_middles_(at_middles) {}
  /// As an integrator's options have it. With one sample a pixel lights are met at their middles, unless soft shadows
  /// are asked for.
  DirectLight(const RayTracer& tracer, const RenderOptions& options);

  /// More rays where shadows end, see RenderOptions::shadow_samples.
  void send_more_at(ShadowBoundaries boundaries) { boundaries_ = std::move(boundaries); }
  /// Whether one shadow ray to each light is all that is sent.
  [[nodiscard]] bool sends_one_ray_each() const { return most_rays_ == 1 && !exact_; }
  /// Whether boundaries are of use.
  [[nodiscard]] bool is_selective() const { return most_rays_ > 1 && !everywhere_; }

  /// Radiance that the surface sends towards `wo`: shadow rays to each light. Lights with a body are met at random
  /// points of theirs; of lights with many parts each point is chosen among several by what it would bring unhindered.
  /// Lobes of roughness up to `roughness_limit` are left out.
  [[nodiscard]] Rgb reflected(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo, double roughness_limit,
                              int depth, PixelSampler& sampler, RayCounts& rays, const Bands& bands = {}) const;

  /// A shadow ray to one light, and what it brings.
  struct Meeting {
    Ray shadow_ray;
    Rgb radiance{0};  ///< that the surface sends towards `wo` because of it; 0 when something stands in the way
    Rgb passed{0};    ///< the share that nothing held up, 0..1
  };
  /// One ray to one light; none when it cannot light the surface at all.
  [[nodiscard]] std::optional<Meeting> meet(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo,
                                            double roughness_limit, std::size_t light, PixelSampler& sampler,
                                            const Bands& bands = {}) const;

  [[nodiscard]] const LightSampler& lights() const { return lights_; }
  [[nodiscard]] const Shadow& shadow() const { return shadow_; }
  /// True when nothing is half transparent, so that one occlusion query decides.
  [[nodiscard]] bool is_binary() const { return shadow_.is_binary(); }

 private:
  // A shading point and the way back along which its light goes.
  struct Receiver {
    const SurfacePoint& point;
    const Bsdf& bsdf;
    const Vec3d& wo;
    Vec3d facing;  // shading normal on the side of wo
    double roughness_limit;
    const Bands& bands;
  };
  // A shadow ray to send, and what it brings when nothing stands in the way.
  struct Candidate {
    Ray shadow_ray;
    Rgb radiance{0};
    Rgb irradiance{0};  // estimate of the light's, on the facing side; of lamps that are met by one choice
  };
  // What a ray to a light would bring, and how much of that passes.
  struct Shaded {
    Rgb open{0};
    Rgb passed{0};
  };

  [[nodiscard]] Receiver receiver(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo, double roughness_limit,
                                  const Bands& bands) const;
  [[nodiscard]] Rgb by_rays(const Receiver& to, std::size_t light, int depth, PixelSampler& sampler,
                            RayCounts& rays) const;
  [[nodiscard]] std::optional<Rgb> exactly(const Receiver& to, std::size_t light, int depth, PixelSampler& sampler,
                                           RayCounts& rays) const;
  [[nodiscard]] Rgb open_light(const Receiver& to, std::size_t light, PixelSampler& sampler) const;
  [[nodiscard]] Rgb flat_radiance(const Receiver& to, std::size_t light) const;
  [[nodiscard]] bool has_body(std::size_t light) const;

  [[nodiscard]] Candidate unhindered(const Receiver& to, const LightSample& light) const;
  [[nodiscard]] Candidate from_light(const Receiver& to, std::size_t light, PixelSampler& sampler) const;
  [[nodiscard]] Candidate from_many_parts(const Receiver& to, std::size_t light, PixelSampler& sampler) const;
  [[nodiscard]] Candidate from_sky(const Receiver& to, PixelSampler& sampler) const;

  LightSampler lights_;
  Shadow shadow_;
  bool at_middles_;
  int most_rays_ = 1;  // that a sample sends to a light
  bool everywhere_ = false;
  bool exact_ = false;
  ShadowBoundaries boundaries_;
  std::optional<PolygonShadows> flat_lamps_;
};

}  // namespace penumbra
