#pragma once

#include <cstdint>

#include "penumbra/math/rng.h"
#include "penumbra/math/sobol.h"

namespace penumbra {

/// The random numbers of one sample of one pixel: Owen-scrambled Sobol points over the samples, independent between
/// pixels and between the dimensions drawn one after the other. They depend on (seed, pixel, sample, dimension) and
/// nothing else.
class PixelSampler {
 public:
  PixelSampler(std::uint64_t seed, int x, int y, int sample)
      : key_(hash_key(seed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))),
        sample_(static_cast<std::uint32_t>(sample)) {}

  [[nodiscard]] double next_1d() { return owen_sobol_1d(sample_, next_key()); }
  [[nodiscard]] Vec2d next_2d() { return owen_sobol_2d(sample_, next_key()); }

 private:
  [[nodiscard]] std::uint64_t next_key() { return key_ + 0x9e3779b97f4a7c15ULL * ++dimension_; }

  std::uint64_t key_;
  std::uint32_t sample_;
  std::uint64_t dimension_ = 0;
};

}  // namespace penumbra
