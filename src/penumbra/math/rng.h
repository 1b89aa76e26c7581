#pragma once

#include <cstdint>

namespace penumbra {

/// Mixes 64 bits so that each input bit flips each output bit with probability near 1/2
/// (the finaliser of SplitMix64; Steele, Lea, Flood 2014, with Stafford's variant 13 constants).
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t v) {
  v ^= v >> 30;
  v *= 0xbf58476d1ce4e5b9ULL;
  v ^= v >> 27;
  v *= 0x94d049bb133111ebULL;
  v ^= v >> 31;
  return v;
}

/// One key from several: order matters.
template <class... Words>
[[nodiscard]] constexpr std::uint64_t hash_key(std::uint64_t first, Words... rest) {
  std::uint64_t h = mix_bits(first + 0x9e3779b97f4a7c15ULL);
  ((h = mix_bits(h ^ (static_cast<std::uint64_t>(rest) + 0x9e3779b97f4a7c15ULL + (h << 6) + (h >> 2)))), ...);
  return h;
}

/// A counter-based random sequence: the n-th number depends on the key and n alone, so results do
/// not depend on threads or order (the idea of Salmon et al. 2011, "Parallel random numbers: as easy
/// as 1, 2, 3"; the mixer is SplitMix64's).
class CounterRng {
 public:
  explicit constexpr CounterRng(std::uint64_t key) : key_(key) {}

  [[nodiscard]] constexpr std::uint64_t next_bits() { return mix_bits(key_ + ++counter_ * 0x9e3779b97f4a7c15ULL); }
  /// Uniform in [0, 1), 53 bits.
  [[nodiscard]] constexpr double next() { return static_cast<double>(next_bits() >> 11) * 0x1p-53; }

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace penumbra
