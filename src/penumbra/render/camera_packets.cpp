#include "penumbra/render/camera_packets.h"

#include "penumbra/render/sobol_lanes.h"

namespace penumbra {

CameraPackets::CameraPackets(const CameraRays& camera, std::uint64_t seed)
    : camera_(camera),
      seed_(seed),
      raster_{Vec3f(camera.eye()), Vec3f(camera.corner()), Vec3f(camera.step_x()), Vec3f(camera.step_y()),
              Vec3f(normalize(cross(camera.step_x(), camera.step_y())))} {}

void CameraPackets::aim(std::span<PixelSample> samples, RayPacket& rays) const {
  Lanes x, y;
  for (std::size_t i = 0; i < RayPacket::size; ++i) {
    const bool used = i < samples.size();
    const PixelSample& sample = samples[used ? i : 0];
    rays.active[i] = used ? -1 : 0;
    x[i] = static_cast<float>(sample.x) + 0.5F;
    y[i] = static_cast<float>(sample.y) + 0.5F;
  }
  if (!camera_.centred()) jitter(samples, x, y);
  for (std::size_t i = 0; i < RayPacket::size; ++i) {
    rays.time[i] = 0;
    if (camera_.is_timed() && i < samples.size()) {
      PixelSampler random(seed_, samples[i].x, samples[i].y, samples[i].number);
      if (!camera_.centred()) random.skip(1);
      rays.time[i] = static_cast<float>(camera_.time(random));
    }
  }
  aim_camera(raster_, x, y, rays);
}

// Moves samples from the middle of their pixels to where the filter draws them.
void CameraPackets::jitter(std::span<PixelSample> samples, Lanes& x, Lanes& y) const {
  KeyLanes key{};
  IndexLanes index{};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const PixelSampler random(seed_, samples[i].x, samples[i].y, samples[i].number);
    key[i] = random.key_after(0);
    index[i] = random.index();
  }
  Lanes u, v;
  owen_sobol_2d(index, key, u, v);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Filter::Position at = camera_.filter().sample({u[i], v[i]});
    x[i] += static_cast<float>(at.offset.x);
    y[i] += static_cast<float>(at.offset.y);
    samples[i].weight = at.weight;
  }
}

int CameraPackets::aim(const PixelBlock& block, int number, RayPacket& rays, std::vector<PixelSample>& samples) const {
  const std::size_t first = samples.size();
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; ++x) samples.push_back({x, y, number});
  }
  aim(std::span(samples).subspan(first), rays);
  return static_cast<int>(samples.size() - first);
}

void add_samples(const std::vector<PixelSample>& samples, Film& film) {
  PixelEstimate seen;
  for (const PixelSample& s : samples) {
    seen.radiance = s.radiance;
    film.add(s.x, s.y, seen, s.weight);
  }
}

}  // namespace penumbra
