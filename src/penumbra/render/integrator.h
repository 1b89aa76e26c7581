#pragma once

#include <memory>
#include <span>

#include "penumbra/render/camera_rays.h"
#include "penumbra/render/film.h"
#include "penumbra/render/pixel_sampler.h"
#include "penumbra/render/render.h"

namespace penumbra {

/// A block of pixels and the samples to take of each.
struct PixelBlock {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;     ///< [x0, x1) x [y0, y1), at most 4 x 4
  int first_sample = 0, last_sample = 0;  ///< [first, last)
};

/// How light is gathered along camera rays. Member functions are thread-safe.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Takes the block's samples, adds them to the film and counts the rays.
  virtual void render(const PixelBlock& block, Film& film, RayCounts& rays) const = 0;
  /// The same for the blocks of a tile, which some integrators trace together.
  virtual void render(std::span<const PixelBlock> blocks, Film& film, RayCounts& rays) const {
    for (const PixelBlock& block : blocks) render(block, film, rays);
  }
  /// Rays that were traced when it was made.
  [[nodiscard]] virtual RayCounts first_pass() const { return {}; }
};

/// An integrator that follows one camera ray at a time.
class RayIntegrator : public Integrator {
 public:
  RayIntegrator(const CameraRays& camera, std::uint64_t seed) : camera_(camera), seed_(seed) {}

  using Integrator::render;
  void render(const PixelBlock& block, Film& film, RayCounts& rays) const override;

  /// What one camera ray sees.
  [[nodiscard]] virtual PixelEstimate estimate(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const = 0;

 protected:
  [[nodiscard]] const CameraRays& camera() const { return camera_; }

 private:
  CameraRays camera_;
  std::uint64_t seed_;
};

/// Builds one of the integrators. `tracer` must outlive it.
[[nodiscard]] std::unique_ptr<Integrator> make_appel(const RayTracer& tracer, const CameraRays& camera,
                                                     const RenderOptions& options);
[[nodiscard]] std::unique_ptr<Integrator> make_whitted(const RayTracer& tracer, const CameraRays& camera,
                                                       const RenderOptions& options);
[[nodiscard]] std::unique_ptr<Integrator> make_path(const RayTracer& tracer, const CameraRays& camera,
                                                    const RenderOptions& options);

}  // namespace penumbra
