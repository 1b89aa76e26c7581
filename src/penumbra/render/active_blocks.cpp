#include "penumbra/render/active_blocks.h"

#include <algorithm>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {

ActiveBlocks::ActiveBlocks(const Region& region, double noise)
    : region_(region),
      noise_(noise),
      columns_((region.x1 - region.x0 + side - 1) / side),
      rows_((region.y1 - region.y0 + side - 1) / side),
      active_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 1),
      squared_errors_(active_.size(), 0),
      count_(active_.size()) {}

double ActiveBlocks::mean_brightness(const Film& film) const {
  double sum = 0;
  for (int y = region_.y0; y < region_.y1; ++y) {
    for (int x = region_.x0; x < region_.x1; ++x) sum += film.brightness(x, y);
  }
  return sum / (static_cast<double>(region_.x1 - region_.x0) * (region_.y1 - region_.y0));
}

double ActiveBlocks::squared_error(const Film& film, int column, int row, double least_brightness) const {
  const int x0 = region_.x0 + column * side, x1 = std::min(region_.x1, x0 + side);
  const int y0 = region_.y0 + row * side, y1 = std::min(region_.y1, y0 + side);
  double sum = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const double bright = std::max(film.brightness(x, y), least_brightness);
      if (bright > 0) sum += film.squared_error(x, y) / (bright * bright);
    }
  }
  return sum / ((x1 - x0) * (y1 - y0));
}

void ActiveBlocks::update(const Film& film) {
  constexpr double darkest = 0.01;  // of the picture's mean
  const double least_brightness = darkest * mean_brightness(film);
  parallel_for(static_cast<std::size_t>(rows_), 1, [&](std::size_t row, std::size_t) {
    for (int column = 0; column < columns_; ++column) {
      if (!is_active(column, static_cast<int>(row))) continue;
      squared_errors_[index(column, static_cast<int>(row))] =
          squared_error(film, column, static_cast<int>(row), least_brightness);
    }
  });
  const double target = noise_ * noise_;
  std::vector<std::uint8_t> next(active_.size(), 0);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (!is_active(column, row)) continue;
      bool noisy = false;
      for (int y = std::max(0, row - 1); y <= std::min(rows_ - 1, row + 1); ++y) {
        for (int x = std::max(0, column - 1); x <= std::min(columns_ - 1, column + 1); ++x) {
          noisy = noisy || squared_errors_[index(x, y)] > target;
        }
      }
      next[index(column, row)] = noisy ? 1 : 0;
    }
  }
  active_ = std::move(next);
  count_ = static_cast<std::size_t>(std::count(active_.begin(), active_.end(), 1));
}

}  // namespace penumbra
