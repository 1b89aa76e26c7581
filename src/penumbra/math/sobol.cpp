#include "penumbra/math/sobol.h"

#include <array>
#include <cassert>

#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

using DirectionNumbers = std::array<std::uint32_t, 32>;

// A primitive polynomial of degree `degree` with inner coefficients `a`, and its initial numbers m_1..m_degree
// (Joe & Kuo 2008, file new-joe-kuo-6).
constexpr DirectionNumbers direction_numbers(int degree, std::uint32_t a, std::array<std::uint32_t, 3> m) {
  DirectionNumbers v{};
  for (int i = 0; i < 32; ++i) {
    if (i < degree) {
      v[i] = m[i] << (31 - i);
      continue;
    }
    v[i] = v[i - degree] ^ (v[i - degree] >> degree);
    for (int k = 1; k < degree; ++k) v[i] ^= ((a >> (degree - 1 - k)) & 1U) * v[i - k];
  }
  return v;
}

constexpr DirectionNumbers van_der_corput() {
  DirectionNumbers v{};
  for (int i = 0; i < 32; ++i) v[i] = 1U << (31 - i);
  return v;
}

constexpr std::array<DirectionNumbers, sobol_dimensions> directions = {
    van_der_corput(), direction_numbers(1, 0, {1, 0, 0}), direction_numbers(2, 1, {1, 3, 0}),
    direction_numbers(3, 1, {1, 3, 1})};

// What each byte of the index contributes, so that a point takes four look-ups: shuffled indices use all 32 bits.
using ByteTable = std::array<std::array<std::uint32_t, 256>, 4>;

constexpr ByteTable byte_table(const DirectionNumbers& v) {
  ByteTable table{};
  for (std::size_t byte = 0; byte < 4; ++byte) {
    for (std::size_t value = 1; value < 256; ++value) {
      std::size_t lowest = 0;
      while (((value >> lowest) & 1U) == 0) ++lowest;
      table[byte][value] = table[byte][value & (value - 1)] ^ v[8 * byte + lowest];
    }
  }
  return table;
}

constexpr std::array<ByteTable, sobol_dimensions> tables = {byte_table(directions[0]), byte_table(directions[1]),
                                                            byte_table(directions[2]), byte_table(directions[3])};

std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  return __builtin_bswap32(x);
}

double fraction(std::uint32_t bits) { return bits * 0x1p-32; }

}  // namespace

std::uint32_t sobol_bits(std::uint32_t index, int dimension) {
  assert(dimension >= 0 && dimension < sobol_dimensions);
  const ByteTable& t = tables[static_cast<std::size_t>(dimension)];
  return t[0][index & 0xFFU] ^ t[1][(index >> 8) & 0xFFU] ^ t[2][(index >> 16) & 0xFFU] ^ t[3][index >> 24];
}

std::uint32_t owen_scramble(std::uint32_t bits, std::uint32_t seed) {
  std::uint32_t x = reverse_bits(bits);
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return reverse_bits(x);
}

Vec2d owen_sobol_2d(std::uint32_t index, std::uint64_t key) {
  const std::uint64_t a = mix_bits(key);
  const std::uint64_t b = mix_bits(key + 0x9e3779b97f4a7c15ULL);
  const std::uint32_t shuffled = owen_scramble(index, static_cast<std::uint32_t>(a));
  return {fraction(owen_scramble(sobol_bits(shuffled, 0), static_cast<std::uint32_t>(a >> 32))),
          fraction(owen_scramble(sobol_bits(shuffled, 1), static_cast<std::uint32_t>(b)))};
}

double owen_sobol_1d(std::uint32_t index, std::uint64_t key) {
  const std::uint64_t a = mix_bits(key);
  const std::uint32_t shuffled = owen_scramble(index, static_cast<std::uint32_t>(a));
  return fraction(owen_scramble(sobol_bits(shuffled, 0), static_cast<std::uint32_t>(a >> 32)));
}

}  // namespace penumbra
