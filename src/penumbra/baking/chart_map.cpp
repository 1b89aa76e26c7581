#include "penumbra/baking/chart_map.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace penumbra {
namespace {

struct Neighbour {
  int dx, dy;
  float weight;
};
constexpr std::array<Neighbour, 8> around{{{-1, 0, 1.0F},
                                           {1, 0, 1.0F},
                                           {0, -1, 1.0F},
                                           {0, 1, 1.0F},
                                           {-1, -1, 0.5F},
                                           {1, -1, 0.5F},
                                           {-1, 1, 0.5F},
                                           {1, 1, 0.5F}}};

/// One kind of pixels filled ring by ring.
class Dilation {
 public:
  Dilation(ChartMap& map, std::span<float> values, std::size_t channels)
      : map_(map), values_(values), channels_(channels), queued_(map.known.size(), 0) {}

  /// @param inside the unknown pixels of charts, or those between charts.
  void run(bool inside, int rings) {
    std::vector<std::uint32_t> ring;
    const auto wanted = [&](std::size_t p) {
      return map_.known[p] == 0 && (map_.charts[p] != ChartMap::none) == inside && queued_[p] == 0;
    };
    for (std::size_t p = 0; p < map_.known.size(); ++p) {
      if (wanted(p) && touches_known(p)) ring.push_back(static_cast<std::uint32_t>(p));
    }
    for (const std::uint32_t p : ring) queued_[p] = 1;
    for (int r = 0; r < rings && !ring.empty(); ++r) {
      fill(ring);
      std::vector<std::uint32_t> next;
      for (const std::uint32_t p : ring) {
        visit(p, [&](std::size_t q, float) {
          if (!wanted(q) || (inside && map_.charts[q] != map_.charts[p])) return;
          queued_[q] = 1;
          next.push_back(static_cast<std::uint32_t>(q));
        });
      }
      std::ranges::sort(next);
      ring = std::move(next);
    }
    std::ranges::fill(queued_, 0);
  }

 private:
  template <class Visit>
  void visit(std::size_t p, const Visit& neighbour) const {
    const int x = static_cast<int>(p % static_cast<std::size_t>(map_.width));
    const int y = static_cast<int>(p / static_cast<std::size_t>(map_.width));
    for (const Neighbour& n : around) {
      const int nx = x + n.dx, ny = y + n.dy;
      if (nx >= 0 && ny >= 0 && nx < map_.width && ny < map_.height) neighbour(map_.index(nx, ny), n.weight);
    }
  }
  [[nodiscard]] bool touches_known(std::size_t p) const { return chart_to_take(p) != ChartMap::none; }

  /// The pixel's own chart when a neighbour knows it; between charts the lowest of the nearest.
  [[nodiscard]] std::uint32_t chart_to_take(std::size_t p) const {
    std::uint32_t best = ChartMap::none;
    float best_weight = 0;
    visit(p, [&](std::size_t q, float weight) {
      if (map_.known[q] == 0 || map_.charts[q] == ChartMap::none) return;
      if (map_.charts[p] != ChartMap::none && map_.charts[q] != map_.charts[p]) return;
      if (weight < best_weight || (weight == best_weight && map_.charts[q] >= best)) return;
      best = map_.charts[q];
      best_weight = weight;
    });
    return best;
  }

  /// All of a ring from what was known before it.
  void fill(const std::vector<std::uint32_t>& ring) {
    std::vector<std::uint32_t> charts;
    charts.reserve(ring.size());
    for (const std::uint32_t p : ring) {
      const std::uint32_t chart = chart_to_take(p);
      charts.push_back(chart);
      float total = 0;
      for (std::size_t c = 0; c < channels_; ++c) values_[p * channels_ + c] = 0;
      visit(p, [&](std::size_t q, float weight) {
        if (map_.known[q] == 0 || map_.charts[q] != chart) return;
        total += weight;
        for (std::size_t c = 0; c < channels_; ++c) {
          values_[p * channels_ + c] += weight * values_[q * channels_ + c];
        }
      });
      for (std::size_t c = 0; c < channels_; ++c) values_[p * channels_ + c] /= total;
    }
    for (std::size_t i = 0; i < ring.size(); ++i) {
      map_.charts[ring[i]] = charts[i];
      map_.known[ring[i]] = 1;
    }
  }

  ChartMap& map_;
  std::span<float> values_;
  std::size_t channels_;
  std::vector<std::uint8_t> queued_;
};

}  // namespace

ChartMap make_chart_map(const LightmapAtlas& atlas, const Texels& texels, std::span<const std::uint8_t> buried) {
  assert(buried.empty() || buried.size() == texels.count());
  ChartMap map{.width = atlas.width, .height = atlas.height, .charts = {}, .known = {}};
  const std::size_t pixels = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  map.charts.assign(pixels, ChartMap::none);
  map.known.assign(pixels, 0);
  for (std::size_t i = 0; i < texels.count(); ++i) {
    map.charts[texels.pixels[i]] = atlas.chart_of_triangle[texels.triangles[i]];
    map.known[texels.pixels[i]] = buried.empty() || buried[i] == 0 ? 1 : 0;
  }
  return map;
}

void dilate(ChartMap& map, std::span<float> values, std::size_t channels, int rings) {
  assert(values.size() == channels * map.known.size());
  Dilation dilation(map, values, channels);
  dilation.run(true, 1 << 20);
  dilation.run(false, rings);
}

}  // namespace penumbra
