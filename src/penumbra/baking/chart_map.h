#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/baking/texels.h"

namespace penumbra {

/// Which chart's light each pixel of an atlas holds, row by row.
struct ChartMap {
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  int width = 0, height = 0;
  std::vector<std::uint32_t> charts;  ///< by pixel; `none` between charts
  std::vector<std::uint8_t> known;    ///< by pixel; 0 where the value is still to come from its neighbours

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// @param buried texels that hold no light of their own; empty for none.
[[nodiscard]] ChartMap make_chart_map(const LightmapAtlas& atlas, const Texels& texels,
                                      std::span<const std::uint8_t> buried = {});

/// Fills unknown pixels from known neighbours, ring by ring: first the unknown ones of charts, each from its own chart,
/// then what lies between, each from the chart that reaches it first (of those, the lowest). Known pixels stay, so no
/// chart bleeds into another. What is filled becomes known.
/// @param values [pixel * channels + channel]. @param rings how far to go beyond charts; the whole atlas by default.
void dilate(ChartMap& map, std::span<float> values, std::size_t channels, int rings = 1 << 20);

}  // namespace penumbra
