#pragma once

#include <cstdint>

#include "penumbra/math/vec.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// How directions are spread over a hemisphere.
enum class Spread {
  cosine,  ///< density cos(theta) / pi
  even     ///< density 1 / (2 pi)
};

/// Sixteen places on surfaces that look over their hemispheres side by side, single precision.
///
/// All lanes share one Owen-scrambled Sobol sequence of directions; each has a digital shift of its own
/// by digits too fine to leave the cell (one of 64) that a direction lies in. So each lane's directions are a
/// (0,2)-sequence, the lanes' rays run nearly parallel wherever their normals agree, and sixteen lanes together are
/// stratified more finely still.
class alignas(64) Outlook {
 public:
  static constexpr int lanes = RayPacket::size;

  /// All lanes empty. @param key of the sequence.
  explicit Outlook(std::uint64_t key, Spread spread = Spread::cosine);

  /// @param position pushed off its surface already. @param normal unit, about which the cosine is.
  /// @param facing unit geometric normal of the side that looks: directions below it are left out.
  void set(int lane, const Vec3d& position, const Vec3d& normal, const Vec3d& facing, std::uint64_t key);
  void clear(int lane) { used_[lane] = 0; }
  [[nodiscard]] bool is_used(int lane) const { return used_[lane] != 0; }

  /// The `index`-th rays of all lanes.
  void rays(std::uint32_t index, RayPacket& packet) const;

 private:
  float origin_[3][lanes], tangent_[3][lanes], bitangent_[3][lanes], normal_[3][lanes], facing_[3][lanes];
  std::uint32_t shift_[2][lanes];
  std::int32_t used_[lanes];
  std::uint32_t seed_[2];
  Spread spread_;
};

}  // namespace penumbra
