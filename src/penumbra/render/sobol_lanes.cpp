#include "penumbra/render/sobol_lanes.h"

#include "penumbra/math/rng.h"
#include "penumbra/math/sobol.h"
#include "penumbra/render/lane_loops.h"

namespace penumbra {
namespace {

constexpr std::size_t n = RayPacket::size;

inline std::uint32_t reversed(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  x = ((x >> 8) & 0x00FF00FFU) | ((x & 0x00FF00FFU) << 8);
  return (x >> 16) | (x << 16);
}

// owen_scramble of bits that are reversed already.
inline std::uint32_t scrambled_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return reversed(x);
}

inline float fraction(std::uint32_t bits) {
  return static_cast<float>(static_cast<std::int32_t>(bits >> 8)) * 0x1p-24F;
}

}  // namespace

PENUMBRA_CLONES void owen_sobol_1d(const IndexLanes& index, const KeyLanes& key, Lanes& u) {
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t a = mix_bits(key[i]);
    const std::uint32_t shuffled = scrambled_reversed(reversed(index[i]), static_cast<std::uint32_t>(a));
    // The first dimension of the sequence reverses the bits of the index: reversed twice, they are the index.
    u[i] = fraction(scrambled_reversed(shuffled, static_cast<std::uint32_t>(a >> 32)));
  }
}

PENUMBRA_CLONES void owen_sobol_2d(const IndexLanes& index, const KeyLanes& key, Lanes& u, Lanes& v) {
  std::uint32_t shuffled[n], second[n], seed[n];
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t a = mix_bits(key[i]);
    seed[i] = static_cast<std::uint32_t>(mix_bits(key[i] + 0x9e3779b97f4a7c15ULL));
    shuffled[i] = scrambled_reversed(reversed(index[i]), static_cast<std::uint32_t>(a));
    u[i] = fraction(scrambled_reversed(shuffled[i], static_cast<std::uint32_t>(a >> 32)));
  }
  for (std::size_t i = 0; i < n; ++i) second[i] = sobol_bits(shuffled[i], 1);
  for (std::size_t i = 0; i < n; ++i) v[i] = fraction(scrambled_reversed(reversed(second[i]), seed[i]));
}

}  // namespace penumbra
