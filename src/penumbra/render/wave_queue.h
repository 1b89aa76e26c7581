#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "penumbra/render/packet_shading.h"

namespace penumbra {

/// Rays that are traced level by level, in waves of sixteen: those of this level, and behind them those that wait for
/// the next. Memory is kept from level to level.
///
/// Waiting rays are sorted as they come: each kind (of a few, such as the octants of their directions) has a wave of
/// its own that is being filled, so that the rays of a wave are alike.
///
/// @tparam Wave has `rays`, a RayPacket, and `used`, how many of its lanes are. @tparam kinds how many kinds there are.
template <class Wave, std::size_t kinds = 1>
class WaveQueue {
 public:
  WaveQueue() { open_.fill(none); }

  /// A wave for the caller to fill, empty.
  Wave& add() {
    if (waiting_count_ == waiting_.size()) waiting_.emplace_back();
    Wave& wave = waiting_[waiting_count_++];
    wave.used = 0;
    return wave;
  }

  /// The wave in which the next ray of a kind has room, in the lane `used`, which is the caller's to fill and count.
  Wave& with_room(std::size_t kind = 0) {
    std::size_t& open = open_[kind];
    if (open != none && waiting_[open].used < RayPacket::size) return waiting_[open];
    open = waiting_count_;
    return add();
  }

  /// The waves that waited, in the order in which they were begun, with unused lanes asleep; now none is waiting. They
  /// live until the next call.
  std::span<Wave> advance() {
    std::swap(now_, waiting_);
    open_.fill(none);
    const std::span<Wave> waves(now_.data(), std::exchange(waiting_count_, 0));
    for (Wave& wave : waves) {
      for (int lane = wave.used; lane < RayPacket::size; ++lane) wave.rays.active[lane] = 0;
    }
    return waves;
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  std::vector<Wave> now_, waiting_;
  std::size_t waiting_count_ = 0;
  std::array<std::size_t, kinds> open_;  // index of the wave of each kind that is being filled
};

/// Puts the ray that leaves from lane `i` into a lane of a packet, awake and without end.
inline void put_ray(const BounceLanes& leaving, std::size_t i, float time, RayPacket& rays, int lane) {
  rays.origin_x[lane] = leaving.origin.x[i];
  rays.origin_y[lane] = leaving.origin.y[i];
  rays.origin_z[lane] = leaving.origin.z[i];
  rays.direction_x[lane] = leaving.direction.x[i];
  rays.direction_y[lane] = leaving.direction.y[i];
  rays.direction_z[lane] = leaving.direction.z[i];
  rays.t_min[lane] = 0;
  rays.t_max[lane] = std::numeric_limits<float>::infinity();
  rays.time[lane] = time;
  rays.active[lane] = -1;
}

}  // namespace penumbra
