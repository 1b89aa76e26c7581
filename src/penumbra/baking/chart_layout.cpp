#include "penumbra/baking/chart_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include "penumbra/baking/rectangle_packing.h"

namespace penumbra {
namespace {

constexpr int largest_atlas = 16384;  // texels; what graphics hardware takes

int whole_texels(double metres, double density) {
  return std::max(1, static_cast<int>(std::lround(std::min(metres * density, 1e6))));
}

int multiple_of(int step, int texels) { return (texels + step - 1) / step * step; }

/// Tries to lay charts at a density.
class Layouts {
 public:
  Layouts(std::span<const Vec2d> sizes, int padding) : sizes_(sizes), padding_(padding) {}

  [[nodiscard]] std::optional<ChartLayout> lay(double density, int size) const {
    const std::vector<PackedSize> padded = padded_sizes(density);
    const auto places = pack_rectangles(padded, size, size);
    if (!places) return std::nullopt;
    ChartLayout layout{.width = 0, .height = 0, .texels_per_metre = density, .charts = {}};
    layout.charts.reserve(padded.size());
    for (std::size_t i = 0; i < padded.size(); ++i) {
      const PackedPlace& at = (*places)[i];
      layout.charts.push_back({.x = at.x + padding_ / 2,
                               .y = at.y + padding_ / 2,
                               .width = padded[i].width - padding_,
                               .height = padded[i].height - padding_});
      layout.width = std::max(layout.width, at.x + padded[i].width);
      layout.height = std::max(layout.height, at.y + padded[i].height);
    }
    const int step = std::max(4, padding_);
    layout.width = std::min(size, multiple_of(step, layout.width));
    layout.height = std::min(size, multiple_of(step, layout.height));
    return layout;
  }

  /// The side of a square that has just room for them, were nothing lost between.
  [[nodiscard]] double least_side(double density) const {
    double area = 0, longest = 0;
    for (const PackedSize& s : padded_sizes(density)) {
      area += static_cast<double>(s.width) * s.height;
      longest = std::max<double>(longest, std::max(s.width, s.height));
    }
    return std::max(std::sqrt(area), longest);
  }

  /// Largest that may fit a square of this side: by area, padding left out, and by the longest.
  [[nodiscard]] double density_limit(int size) const {
    double area = 0, longest = 0;
    for (const Vec2d& s : sizes_) {
      area += s.x * s.y;
      longest = std::max(longest, s.x);
    }
    const double by_length = longest > 0 ? (size + 0.5 - padding_) / longest : 1;
    return area > 0 ? std::min(by_length, 2 * size / std::sqrt(area)) : by_length;
  }

 private:
  [[nodiscard]] std::vector<PackedSize> padded_sizes(double density) const {
    std::vector<PackedSize> padded;
    padded.reserve(sizes_.size());
    for (const Vec2d& s : sizes_) {
      padded.push_back({whole_texels(s.x, density) + padding_, whole_texels(s.y, density) + padding_});
    }
    return padded;
  }

  std::span<const Vec2d> sizes_;
  int padding_;
};

/// Bisects the density: charts may fit by luck at more than at a little less, so the answer is near the largest.
ChartLayout densest(const Layouts& layouts, int size, std::size_t charts) {
  constexpr int halvings = 16;
  std::optional<ChartLayout> best = layouts.lay(0, size);
  if (!best) {
    throw std::invalid_argument(
        fmt::format("{} charts do not fit an atlas of {} texels a side, even with one texel each; take {} or more",
                    charts, size, multiple_of(4, static_cast<int>(1.1 * layouts.least_side(0)))));
  }
  double high = layouts.density_limit(size), low = 0;
  if (std::optional<ChartLayout> all = layouts.lay(high, size)) return *all;
  for (int i = 0; i < halvings && high > low * 1.0001; ++i) {
    const double middle = low > high / 64 ? 0.5 * (low + high) : std::max(low, high / 8);
    if (std::optional<ChartLayout> laid = layouts.lay(middle, size)) {
      best = std::move(laid);
      low = middle;
    } else {
      high = middle;
    }
  }
  return *best;
}

ChartLayout smallest(const Layouts& layouts, double density) {
  int size = multiple_of(4, static_cast<int>(std::ceil(std::min(layouts.least_side(density), 1e6))));
  while (size <= largest_atlas) {
    if (std::optional<ChartLayout> laid = layouts.lay(density, size)) return *laid;
    size = multiple_of(4, size + 1 + size / 64);
  }
  throw std::invalid_argument(fmt::format(
      "at {} texels a metre the atlas would be larger than {} texels a side; ask for fewer", density, largest_atlas));
}

}  // namespace

int chart_padding(const AtlasOptions& options) { return std::max(2, 1 << options.mip_levels); }

ChartLayout lay_out_charts(std::span<const Vec2d> sizes, const AtlasOptions& options) {
  const Layouts layouts(sizes, chart_padding(options));
  if (options.texels_per_metre > 0) return smallest(layouts, options.texels_per_metre);
  return densest(layouts, options.size > 0 ? options.size : 1024, sizes.size());
}

}  // namespace penumbra
