#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <unordered_map>
#include <vector>

#include "penumbra/math/rng.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Numbers positions so that exactly equal ones (0 and -0 are equal) share a number.
class VertexWelder {
 public:
  explicit VertexWelder(std::vector<Vec3d>& positions) : positions_(positions) {}

  /// The number of `p` in the positions, where it is appended when new. @pre `p` is finite.
  std::uint32_t number(const Vec3d& p) {
    const Vec3d key = p + 0.0;  // -0 becomes 0
    const auto [found, fresh] = numbers_.emplace(key, static_cast<std::uint32_t>(positions_.size()));
    if (fresh) positions_.push_back(key);
    return found->second;
  }

 private:
  struct Hash {
    std::size_t operator()(const Vec3d& p) const {
      std::array<std::uint64_t, 3> bits{};
      std::memcpy(bits.data(), &p, sizeof bits);
      return hash_key(bits[0], bits[1], bits[2]);
    }
  };
  std::vector<Vec3d>& positions_;
  std::unordered_map<Vec3d, std::uint32_t, Hash> numbers_;
};

}  // namespace penumbra
