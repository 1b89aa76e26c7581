#pragma once

#include <span>
#include <vector>

#include "penumbra/render/camera_rays.h"
#include "penumbra/render/film.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/packet_shading.h"

namespace penumbra {

/// A sample of a pixel, while it is drawn.
struct PixelSample {
  int x = 0, y = 0, number = 0;
  float weight = 1;  ///< of the filter
  Rgb radiance{0};
};

/// Sends a pinhole camera's rays in packets.
class CameraPackets {
 public:
  /// @pre camera.is_pinhole(); it must outlive this.
  CameraPackets(const CameraRays& camera, std::uint64_t seed);

  /// Aims a ray at each of up to sixteen samples and sets their weights. The lanes after them sleep.
  void aim(std::span<PixelSample> samples, RayPacket& rays) const;
  /// Aims at the block's sample of this number and appends a sample for each lane used; returns how many are.
  int aim(const PixelBlock& block, int number, RayPacket& rays, std::vector<PixelSample>& samples) const;

  /// The random numbers of a sample after those that placed it in its pixel.
  [[nodiscard]] PixelSampler sampler(const PixelSample& sample) const {
    PixelSampler random(seed_, sample.x, sample.y, sample.number);
    random.skip(numbers_used());
    return random;
  }
  /// How many random numbers place a sample.
  [[nodiscard]] int numbers_used() const { return camera_.drawn(); }
  [[nodiscard]] const CameraRays& rays() const { return camera_; }
  [[nodiscard]] const RasterDirections& raster() const { return raster_; }

 private:
  void jitter(std::span<PixelSample> samples, Lanes& x, Lanes& y) const;

  const CameraRays& camera_;
  std::uint64_t seed_;
  RasterDirections raster_;
};

/// Adds drawn samples to the film in their order.
void add_samples(const std::vector<PixelSample>& samples, Film& film);

}  // namespace penumbra
