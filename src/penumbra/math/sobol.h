#pragma once

#include <cstdint>

#include "penumbra/math/vec.h"

namespace penumbra {

/// How many dimensions of the Sobol sequence are tabulated.
inline constexpr int sobol_dimensions = 4;

/// The `index`-th point of the Sobol sequence in one dimension, as 32 fraction bits
/// (direction numbers of Joe & Kuo 2008). @pre 0 <= dimension < sobol_dimensions.
[[nodiscard]] std::uint32_t sobol_bits(std::uint32_t index, int dimension);

/// Owen's nested uniform scrambling of 32 fraction bits by a hash (Burley, "Practical Hash-based Owen Scrambling",
/// JCGT 9(4), 2020; hash constants of N. Vegdahl 2021). The same seed keeps a net a net.
[[nodiscard]] std::uint32_t owen_scramble(std::uint32_t bits, std::uint32_t seed);

/// The `index`-th point of an Owen-scrambled, shuffled (0,2)-sequence in [0,1)^2. Different keys give independent
/// sequences, so high-dimensional samples are padded from several (Kollig & Keller 2002).
[[nodiscard]] Vec2d owen_sobol_2d(std::uint32_t index, std::uint64_t key);

/// The same in one dimension.
[[nodiscard]] double owen_sobol_1d(std::uint32_t index, std::uint64_t key);

}  // namespace penumbra
