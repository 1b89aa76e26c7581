#include "penumbra/render/camera_packets.h"

namespace penumbra {

CameraPackets::CameraPackets(const CameraRays& camera, std::uint64_t seed)
    : camera_(camera),
      seed_(seed),
      raster_{Vec3f(camera.eye()), Vec3f(camera.corner()), Vec3f(camera.step_x()), Vec3f(camera.step_y())} {}

int CameraPackets::aim(const PixelBlock& block, int number, RayPacket& rays, std::vector<PixelSample>& samples) const {
  const int width = block.x1 - block.x0;
  const int used = width * (block.y1 - block.y0);
  Lanes x, y;
  for (int lane = 0; lane < RayPacket::size; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    rays.active[lane] = lane < used ? -1 : 0;
    PixelSample sample{block.x0 + std::min(lane, used - 1) % width, block.y0 + std::min(lane, used - 1) / width,
                       number};
    Vec2d offset(0);
    PixelSampler random(seed_, sample.x, sample.y, number);
    if (!camera_.centred() && lane < used) {
      const Filter::Position at = camera_.sub_pixel(random);
      offset = at.offset;
      sample.weight = at.weight;
    }
    rays.time[lane] = static_cast<float>(camera_.time(random));
    x[i] = static_cast<float>(sample.x + 0.5 + offset.x);
    y[i] = static_cast<float>(sample.y + 0.5 + offset.y);
    if (lane < used) samples.push_back(sample);
  }
  aim_camera(raster_, x, y, rays);
  return used;
}

void add_samples(const std::vector<PixelSample>& samples, Film& film) {
  PixelEstimate seen;
  for (const PixelSample& s : samples) {
    seen.radiance = s.radiance;
    film.add(s.x, s.y, seen, s.weight);
  }
}

}  // namespace penumbra
