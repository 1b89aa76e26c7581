#pragma once

#include <optional>

#include "penumbra/render/pixel_sampler.h"
#include "penumbra/render/render.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "penumbra/tracing/shading/shadow.h"

namespace penumbra {

/// Light that reaches a surface straight from every light of the scene: Appel's and Whitted's shadow rays ('shadow
/// feelers').
class DirectLight {
 public:
  /// @param through_glass whether transparent surfaces let shadow rays pass, see Shadow.
  /// @param at_middles whether lights are met at their middle where they have one: sharp shadows without noise.
  DirectLight(const RayTracer& tracer, bool through_glass, bool at_middles)
      : lights_(tracer.scene()), shadow_(tracer, through_glass), at_middles_(at_middles) {}

  /// Radiance that the surface sends towards `wo`: one shadow ray to each light. Lights with a body are met at a random
  /// point of theirs, so that several samples a pixel make soft shadows; of lights with many parts the point is chosen
  /// among several by what it would bring unhindered. Lobes of roughness up to `roughness_limit` are left out.
  [[nodiscard]] Rgb reflected(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo, double roughness_limit,
                              int depth, PixelSampler& sampler, RayCounts& rays) const;

  /// A shadow ray to one light, and what it brings.
  struct Meeting {
    Ray shadow_ray;
    Rgb radiance{0};  ///< that the surface sends towards `wo` because of it; 0 when something stands in the way
  };
  /// The same for one light; none when it cannot light the surface at all.
  [[nodiscard]] std::optional<Meeting> meet(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo,
                                            double roughness_limit, std::size_t light, PixelSampler& sampler) const;

  [[nodiscard]] const LightSampler& lights() const { return lights_; }
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
  };
  // A shadow ray to send, and what it brings when nothing stands in the way.
  struct Candidate {
    Ray shadow_ray;
    Rgb radiance{0};
  };

  [[nodiscard]] Candidate unhindered(const Receiver& to, const LightSample& light) const;
  [[nodiscard]] Candidate from_light(const Receiver& to, std::size_t light, PixelSampler& sampler) const;
  [[nodiscard]] Candidate from_many_parts(const Receiver& to, std::size_t light, PixelSampler& sampler) const;
  [[nodiscard]] Candidate from_sky(const Receiver& to, PixelSampler& sampler) const;

  LightSampler lights_;
  Shadow shadow_;
  bool at_middles_;
};

}  // namespace penumbra
