#include "penumbra/render/ray_waves.h"

#include <utility>

#include "penumbra/render/ray_batch.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {
namespace {

constexpr std::size_t most_samples_a_batch = 2048;  // the waves of so many stay in the second-level cache

}  // namespace

RayWaves::RayWaves(const RayTracer& tracer, const CameraRays& camera, const LightSampler& lights,
                   std::vector<PacketLight> packet_lights, const Options& options)
    : tracer_(tracer),
      camera_(camera, options.seed),
      lights_(lights),
      packet_lights_(std::move(packet_lights)),
      options_(options),
      shadow_(tracer, options.through_glass),
      surfaces_(tracer),
      packet_shadow_(tracer, surfaces_, shadow_) {
  for (const PacketLight& l : packet_lights_) {
    const PacketLight::Triangle point{.v0 = l.position,
                                      .e1 = Vec3f(0),
                                      .e2 = Vec3f(0),
                                      .normal = Vec3f(0),
                                      .inverse_density = 1,
                                      .radiance = l.strength,
                                      .both_sides = false};
    const PacketLight::Triangle& t = l.kind == PacketLight::Kind::area ? l.triangles[0] : point;
    LightPoints& points = fixed_points_.emplace_back();
    for (std::size_t i = 0; i < RayPacket::size; ++i) points.set(i, t, t.v0);
  }
}

RayWaves::~RayWaves() = default;

std::unique_ptr<RayWaves> RayWaves::make(const RayTracer& tracer, const CameraRays& camera, const LightSampler& lights,
                                         const Options& options) {
  if (!camera.is_pinhole() || !Media(tracer.scene()).none()) return nullptr;
  auto packet_lights = penumbra::packet_lights(tracer.scene(), lights, options.at_middles);
  if (!packet_lights) return nullptr;
  return std::unique_ptr<RayWaves>(new RayWaves(tracer, camera, lights, std::move(*packet_lights), options));
}

void RayWaves::render(std::span<const PixelBlock> blocks, const Others& others, Film& film, RayCounts& rays) const {
  std::unique_ptr<Batch> batch = take_batch();
  for (const PixelBlock& block : blocks) {
    batch->start(block);
    const bool full = batch->size() >= most_samples_a_batch;
    if (!full && &block != &blocks.back()) continue;
    batch->trace(others, rays);
    batch->add_to(film);
    batch->clear();
  }
  const std::scoped_lock lock(idle_lock_);
  idle_.push_back(std::move(batch));
}

std::unique_ptr<RayWaves::Batch> RayWaves::take_batch() const {
  const std::scoped_lock lock(idle_lock_);
  if (idle_.empty()) return std::make_unique<Batch>(*this);
  std::unique_ptr<Batch> batch = std::move(idle_.back());
  idle_.pop_back();
  return batch;
}

}  // namespace penumbra
