#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "penumbra/render/packet_shading.h"

namespace penumbra {

/// Rays that are traced level by level, in waves of sixteen: those of this level, and behind them those that wait for
/// the next. Memory is kept from level to level. Rays wait in the order in which they come: neighbours in the picture
/// stay neighbours, which serves the processor's caches as well as any sorting did.
///
/// @tparam Wave has `rays`, a RayPacket, and `used`, how many of its lanes are.
template <class Wave>
class WaveQueue {
 public:
  /// A wave for the caller to fill, empty.
  Wave& add() {
    if (waiting_count_ == waiting_.size()) waiting_.emplace_back();
    Wave& wave = waiting_[waiting_count_++];
    wave.used = 0;
    return wave;
  }

  /// The wave in which the next ray has room, in the lane `used`, which is the caller's to fill and count.
  Wave& with_room() {
    const bool has_room = waiting_count_ > 0 && waiting_[waiting_count_ - 1].used < RayPacket::size;
    return has_room ? waiting_[waiting_count_ - 1] : add();
  }

  /// The waves that waited, in the order in which they were begun, with unused lanes asleep; now none is waiting. They
  /// live until the next call.
  std::span<Wave> advance() {
    std::swap(now_, waiting_);
    const std::span<Wave> waves(now_.data(), std::exchange(waiting_count_, 0));
    for (Wave& wave : waves) {
      for (int lane = wave.used; lane < RayPacket::size; ++lane) wave.rays.active[lane] = 0;
    }
    return waves;
  }

 private:
  std::vector<Wave> now_, waiting_;
  std::size_t waiting_count_ = 0;
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
