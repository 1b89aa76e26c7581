#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "penumbra/render/film.h"

namespace penumbra {

/// The blocks of 4 x 4 pixels that still need samples.
///
/// A block's error is the root of the mean over its pixels of (standard error / brightness)^2, where brightness is at
/// least a hundredth of the picture's mean. It is done when its own error and those of its eight neighbours are within
/// the target: a block in which chance hid a lamp's edge so far is kept awake by a neighbour that saw it, and decisions
/// that rest on hundreds of samples, never on one pixel's, leave next to no bias (Kirk & Arvo 1991 show the bias of
/// deciding by a pixel's own few). A block that is done stays done.
class ActiveBlocks {
 public:
  static constexpr int side = 4;  ///< pixels

  /// All blocks of a region are active; the first begins in its top left corner.
  ActiveBlocks(const Region& region, double noise);

  [[nodiscard]] bool is_active(int column, int row) const { return active_[index(column, row)] != 0; }
  [[nodiscard]] std::size_t block_count() const { return active_.size(); }
  [[nodiscard]] std::size_t active_count() const { return count_; }

  /// Puts blocks that are done to rest. @pre every pixel has at least two samples.
  void update(const Film& film);

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] double mean_brightness(const Film& film) const;
  [[nodiscard]] double squared_error(const Film& film, int column, int row, double least_brightness) const;

  Region region_;
  double noise_;
  int columns_, rows_;
  std::vector<std::uint8_t> active_;
  std::vector<double> squared_errors_;
  std::size_t count_;
};

}  // namespace penumbra
