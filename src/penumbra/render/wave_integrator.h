#pragma once

#include "penumbra/render/direct_light.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/ray_waves.h"
#include "penumbra/tracing/shading/specular_tree.h"

namespace penumbra {

/// What Appel's and Whitted's integrators share: direct light by shadow rays, of which a first pass may say where many
/// are needed, and waves of rays where surfaces and lights are plain.
class WaveIntegrator : public RayIntegrator, private RayWaves::Others {
 public:
  [[nodiscard]] RayCounts first_pass() const override { return first_pass_; }

  using RayIntegrator::render;
  void render(std::span<const PixelBlock> blocks, Film& film, RayCounts& rays) const override {
    waves_ && !film.has_layers() ? waves_->render(blocks, *this, film, rays)
                                 : RayIntegrator::render(blocks, film, rays);
  }

 protected:
  /// How far rays are followed.
  struct Reach {
    int max_depth = 0;
    float min_throughput = 0;
  };

  WaveIntegrator(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options)
      : RayIntegrator(camera, options.seed), textures_(tracer), direct_(tracer, options) {}

  /// Sends the first pass where one is asked for, and makes the waves. Both ways, by waves and ray by ray, draw the
  /// same random numbers and differ by rounding alone.
  void prepare(const SpecularTree& tree, const RenderOptions& options, const Reach& reach);

  [[nodiscard]] const FilteredTextures& textures() const { return textures_; }
  [[nodiscard]] const DirectLight& direct() const { return direct_; }

 private:
  FilteredTextures textures_;
  DirectLight direct_;
  RayCounts first_pass_;
  std::unique_ptr<RayWaves> waves_;
};

}  // namespace penumbra
