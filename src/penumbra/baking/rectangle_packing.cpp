#include "penumbra/baking/rectangle_packing.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace penumbra {
namespace {

constexpr std::size_t most_on_a_skyline = 4096;

std::vector<std::uint32_t> highest_first(std::span<const PackedSize> sizes) {
  std::vector<std::uint32_t> order(sizes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(sizes[b].height, sizes[b].width, a) < std::tie(sizes[a].height, sizes[a].width, b);
  });
  return order;
}

/// The upper outline of what is laid so far.
class Skyline {
 public:
  Skyline(int width, int height) : width_(width), height_(height), steps_{{0, 0}} {}

  /// At the lowest place, of those the leftmost.
  std::optional<PackedPlace> lay(const PackedSize& size) {
    std::size_t best = steps_.size();
    int best_y = height_ - size.height + 1;
    for (std::size_t i = 0; i < steps_.size() && steps_[i].x + size.width <= width_; ++i) {
      const int y = level(i, size.width, best_y);
      if (y < best_y) best = i, best_y = y;
    }
    if (best == steps_.size()) return std::nullopt;
    const PackedPlace place{steps_[best].x, best_y};
    raise(best, place.x, size.width, best_y + size.height);
    return place;
  }

 private:
  struct Step {
    int x = 0, y = 0;  // from x on the outline is at y
  };

  /// The height at which something so wide rests from step i on; `enough` or more when it is no better.
  [[nodiscard]] int level(std::size_t i, int width, int enough) const {
    const int end = steps_[i].x + width;
    int y = steps_[i].y;
    for (std::size_t k = i + 1; k < steps_.size() && steps_[k].x < end && y < enough; ++k) y = std::max(y, steps_[k].y);
    return y;
  }

  void raise(std::size_t i, int x, int width, int y) {
    const int end = x + width;
    std::size_t last = i;
    int after = steps_[i].y;  // what the outline is at `end`
    while (last < steps_.size() && steps_[last].x < end) after = steps_[last++].y;
    const bool ends_between = end < width_ && (last == steps_.size() || steps_[last].x > end);
    const auto at = [&](std::size_t k) { return steps_.begin() + static_cast<std::ptrdiff_t>(k); };
    steps_.erase(at(i), at(last));
    if (ends_between) steps_.insert(at(i), {end, after});
    steps_.insert(at(i), {x, y});
  }

  int width_, height_;
  std::vector<Step> steps_;
};

/// Rows one above the other, each as high as its first.
class Shelves {
 public:
  Shelves(int width, int height) : width_(width), height_(height) {}

  std::optional<PackedPlace> lay(const PackedSize& size) {
    if (x_ + size.width > width_) {
      y_ += shelf_;
      x_ = shelf_ = 0;
    }
    if (shelf_ == 0) shelf_ = size.height;
    if (x_ + size.width > width_ || y_ + shelf_ > height_) return std::nullopt;
    const PackedPlace place{x_, y_};
    x_ += size.width;
    return place;
  }

 private:
  int width_, height_;
  int x_ = 0, y_ = 0, shelf_ = 0;
};

template <class Bin>
std::optional<std::vector<PackedPlace>> pack(std::span<const PackedSize> sizes, Bin bin) {
  std::vector<PackedPlace> places(sizes.size());
  for (const std::uint32_t i : highest_first(sizes)) {
    const std::optional<PackedPlace> place = bin.lay(sizes[i]);
    if (!place) return std::nullopt;
    places[i] = *place;
  }
  return places;
}

}  // namespace

std::optional<std::vector<PackedPlace>> pack_rectangles(std::span<const PackedSize> sizes, int width, int height) {
  std::int64_t area = 0;
  for (const PackedSize& s : sizes) area += std::int64_t{s.width} * s.height;
  if (area > std::int64_t{width} * height) return std::nullopt;
  if (sizes.size() <= most_on_a_skyline) return pack(sizes, Skyline(width, height));
  return pack(sizes, Shelves(width, height));
}

}  // namespace penumbra
