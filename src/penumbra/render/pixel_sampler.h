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
        sample_(static_cast<std::uint32_t>(sample)),
        x_(x),
        y_(y) {}

  [[nodiscard]] double next_1d() { return owen_sobol_1d(sample_, next_key()); }
  [[nodiscard]] Vec2d next_2d() { return owen_sobol_2d(sample_, next_key()); }

  /// The pixel.
  [[nodiscard]] int x() const { return x_; }
  [[nodiscard]] int y() const { return y_; }

  /// Many draws of one kind in one sample, such as several points of a lamp: those of all samples of the pixel are one
  /// sequence, as evenly spread as if each belonged to a sample of its own.
  class Draws {
   public:
    /// Random numbers of the draw of this number. @pre number < the count that was asked for.
    [[nodiscard]] PixelSampler operator()(std::uint32_t number) const {
      PixelSampler draw = *owner_;
      draw.key_ = key_;
      draw.sample_ = owner_->sample_ * count_ + number;
      draw.dimension_ = 0;
      return draw;
    }

   private:
    friend class PixelSampler;
    Draws(const PixelSampler& owner, std::uint64_t key, std::uint32_t count)
        : owner_(&owner), key_(key), count_(count) {}
    const PixelSampler* owner_;
    std::uint64_t key_;
    std::uint32_t count_;
  };
  /// The sampler must outlive them.
  [[nodiscard]] Draws next_draws(std::uint32_t count) { return {*this, mix_bits(next_key()), count}; }

  /// Leaves out numbers that nobody needs.
  void skip(int numbers) { dimension_ += static_cast<std::uint64_t>(numbers); }

  /// The key of the number after `skipped` more: owen_sobol_1d or _2d make the number of it and of `index()`.
  [[nodiscard]] std::uint64_t key_after(int skipped) const {
    return key_ + 0x9e3779b97f4a7c15ULL * (dimension_ + static_cast<std::uint64_t>(skipped) + 1);
  }
  /// The key of the number `numbers` after that of this key.
  [[nodiscard]] static std::uint64_t later_key(std::uint64_t key, int numbers) {
    return key + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(numbers);
  }
  [[nodiscard]] std::uint32_t index() const { return sample_; }

  /// The numbers of one node of a tree of rays, whatever was drawn elsewhere in the tree.
  [[nodiscard]] PixelSampler at_node(std::uint32_t node) const {
    PixelSampler own = *this;
    own.key_ = hash_key(key_, node);
    own.dimension_ = 0;
    return own;
  }

 private:
  [[nodiscard]] std::uint64_t next_key() { return key_ + 0x9e3779b97f4a7c15ULL * ++dimension_; }

  std::uint64_t key_;
  std::uint32_t sample_;
  std::uint64_t dimension_ = 0;
  int x_, y_;
};

}  // namespace penumbra
