#pragma once

#include <memory>
#include <span>

#include "penumbra/render/camera_packets.h"
#include "penumbra/render/light_points.h"
#include "penumbra/render/packet_surfaces.h"
#include "penumbra/tracing/shading/light_sampling.h"

namespace penumbra {

/// Path tracing bounce by bounce, sixteen paths at a time, in scenes of matt surfaces and flat lamps: all paths of a
/// tile meet their surfaces, send their shadow rays, bounce, and those that live on close ranks for the next bounce.
///
/// The same estimator as `path` everywhere else, with the same random numbers, in red, green and blue or in
/// wavelengths; only the lamps' points are chosen otherwise: by power over all lamps, since every lane has to have the
/// same density.
class PathWaves {
 public:
  struct Options {
    int max_depth = 0;      ///< bounces; 0: no limit
    bool spectral = false;  ///< each sample carries three wavelengths of its own
    std::uint64_t seed = 0;
  };

  /// None when the scene or the camera is of another kind, or spectral light meets dyes or lamps of other spectra. All
  /// but `options` must outlive it.
  [[nodiscard]] static std::unique_ptr<PathWaves> make(const RayTracer& tracer, const CameraRays& camera,
                                                       const LightSampler& lights, const Options& options);
  ~PathWaves();

  /// As Integrator::render; the film has no layers.
  void render(std::span<const PixelBlock> blocks, Film& film, RayCounts& rays) const;

 private:
  struct Wave;
  struct Lit;
  class Batch;

  PathWaves(const RayTracer& tracer, const CameraRays& camera, const LightSampler& lights, PacketLight lamps,
            const Options& options);

  const RayTracer& tracer_;
  CameraPackets camera_;
  const LightSampler& lights_;
  PacketLight lamps_;  // the triangles of all, each with its density by power
  Options options_;
  PacketSurfaces surfaces_;
};

}  // namespace penumbra
