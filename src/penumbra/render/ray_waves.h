#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "penumbra/render/camera_packets.h"
#include "penumbra/render/direct_light.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/light_points.h"
#include "penumbra/render/packet_shadow.h"
#include "penumbra/render/packet_surfaces.h"
#include "penumbra/tracing/shading/filtered_textures.h"

namespace penumbra {

/// A tree of rays breadth first, sixteen at a time: the camera rays of a tile are met and shaded, their shadow rays
/// sent, and the rays that go on from there are the next wave. What a surface shines is added to its sample with the
/// weight that its ray carries, so nothing has to be returned up the tree.
///
/// Lanes on plain matt, glossy, mirroring and clear glass surfaces are shaded side by side (packet_shading.h); any
/// other lane is handed over. Both ways are the same picture up to rounding.
class RayWaves {
 public:
  struct Options {
    int max_depth = 0;                           ///< 0: only camera rays and their shadow rays
    float min_throughput = 0;                    ///< rays that carry less are not followed
    bool at_middles = false;                     ///< lights are met at their middle
    bool through_glass = true;                   ///< see Shadow
    const FilteredTextures* textures = nullptr;  ///< whose chequers are averaged; must outlive the waves
    std::uint64_t seed = 0;
  };

  /// Shades a ray whose surface is not the waves' business.
  class Others {
   public:
    virtual ~Others() = default;
    /// Radiance that comes back along a ray of this weight and depth, with all that follows from it. The ray itself is
    /// counted already. @param differential of the ray, where there is anything to filter.
    virtual Rgb trace(const Ray& ray, const Rgb& weight, int depth, const std::optional<RayDifferential>& differential,
                      PixelSampler& sampler, RayCounts& rays) const = 0;
  };

  /// None when the camera or the lights are not for packets; layers of the film are not either. All but `options` must
  /// outlive it.
  [[nodiscard]] static std::unique_ptr<RayWaves> make(const RayTracer& tracer, const CameraRays& camera,
                                                      const LightSampler& lights, const Options& options);

  ~RayWaves();

  /// As Integrator::render.
  void render(std::span<const PixelBlock> blocks, const Others& others, Film& film, RayCounts& rays) const;

 private:
  [[nodiscard]] bool filters() const { return options_.textures != nullptr && options_.textures->any(); }
  struct Wave;
  struct LightPoints;
  class Batch;

  RayWaves(const RayTracer& tracer, const CameraRays& camera, const LightSampler& lights,
           std::vector<PacketLight> packet_lights, const Options& options);

  [[nodiscard]] std::unique_ptr<Batch> take_batch() const;

  const RayTracer& tracer_;
  CameraPackets camera_;
  const LightSampler& lights_;
  std::vector<PacketLight> packet_lights_;
  Options options_;
  Shadow shadow_;
  PacketSurfaces surfaces_;
  PacketShadow packet_shadow_;
  std::vector<LightPoints> fixed_points_;  // by light: where all rays to it go, when it is met at one point
  mutable std::mutex idle_lock_;
  mutable std::vector<std::unique_ptr<Batch>> idle_;  // their memory is used again
};

}  // namespace penumbra
