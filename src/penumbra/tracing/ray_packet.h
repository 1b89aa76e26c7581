#pragma once

#include <cstdint>

namespace penumbra {

/// Sixteen rays side by side, single precision, for coherent work such as the tiles of a picture.
struct alignas(64) RayPacket {
  static constexpr int size = 16;
  float origin_x[size], origin_y[size], origin_z[size];
  float t_min[size];
  float direction_x[size], direction_y[size], direction_z[size];
  float t_max[size];
  float time[size] = {};      ///< as Ray::time
  std::int32_t active[size];  ///< -1 to trace this lane, 0 to skip it
};

/// What a packet hit; `object` is `no_hit` in lanes that missed or were skipped.
struct alignas(64) HitPacket {
  static constexpr std::uint32_t no_hit = 0xFFFFFFFFU;
  float t[RayPacket::size];
  float normal_x[RayPacket::size], normal_y[RayPacket::size],
      normal_z[RayPacket::size];  ///< geometric, towards the front, not unit
  float u[RayPacket::size], v[RayPacket::size];
  std::uint32_t object[RayPacket::size];
  std::uint32_t primitive[RayPacket::size];
};

}  // namespace penumbra
