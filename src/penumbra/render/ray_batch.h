#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/render/packet_differentials.h"
#include "penumbra/render/ray_waves.h"

namespace penumbra {

/// Sixteen rays, what they carry, and whose they are.
struct alignas(64) RayWaves::Wave {
  RayPacket rays;
  ColourLanes weight;
  std::uint32_t sample[RayPacket::size];
  std::uint32_t node[RayPacket::size];  ///< of the tree of rays: 2 node and 2 node + 1 follow a node
  DifferentialLanes differential;       ///< where something is filtered
  int used = 0;

  [[nodiscard]] Ray ray(int lane) const;
  [[nodiscard]] RayDifferential differential_of(std::size_t lane) const;
};

/// A light's points for sixteen surfaces, and its radiance there (or strength).
struct alignas(64) RayWaves::LightPoints {
  LightLanes lanes{};
  ColourLanes radiance{};

  void set(std::size_t lane, const PacketLight::Triangle& triangle, const Vec3f& position);
};

/// The samples that are drawn together, from their camera rays to the last wave.
class RayWaves::Batch {
 public:
  explicit Batch(const RayWaves& owner) : owner_(owner) {}

  /// Takes the samples of a block in.
  void start(const PixelBlock& block);
  /// Follows all of them to their ends and counts the rays.
  void trace(const Others& others, RayCounts& rays);
  void add_to(Film& film) const { add_samples(samples_, film); }
  void clear() { samples_.clear(), aimed_ = 0; }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }

 private:
  struct Lit;

  void aim(std::size_t count);
  void trace_waves(std::size_t waves);
  void shade(const Wave& wave, const HitPacket& hits);
  void classify(const Wave& wave, Lit& lit);
  void hand_over(const Wave& wave, int lane);
  void shine(const Wave& wave, Lit& lit) const;
  void layer(Lit& lit) const;
  void mix_checkers(const Wave& wave, Lit& lit) const;
  void light(const Wave& wave, Lit& lit);
  void draw_points(const PacketLight& light, int number, const Wave& wave, const Lit& lit, LightPoints& points) const;
  void go_on(const Wave& wave, Lit& lit);
  void bend(const Wave& wave, const Lit& lit, FootprintLanes& changes) const;
  void follow(const Wave& wave, int lane, const BounceLanes& bounce, const DifferentialLanes& differential,
              const Rgb& share, bool refracted);
  Wave& open_wave();
  [[nodiscard]] PixelSampler sampler(const Wave& wave, int lane) const;

  const RayWaves& owner_;
  std::vector<PixelSample> samples_;
  std::size_t aimed_ = 0;  // of the samples
  std::vector<Wave> now_, next_;
  std::size_t next_count_ = 0;
  int depth_ = 0;
  std::uint64_t reflections_ = 0, refractions_ = 0;  // in the next wave
  const Others* others_ = nullptr;                   // while it traces
  RayCounts* rays_ = nullptr;
};

}  // namespace penumbra
