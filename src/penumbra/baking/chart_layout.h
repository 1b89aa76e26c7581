#pragma once

#include <span>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Where charts stand in an atlas, texels.
struct ChartLayout {
  int width = 0, height = 0;  ///< of the atlas, multiples of 4
  double texels_per_metre = 0;
  std::vector<Chart> charts;  ///< without their objects
};

/// How many texels charts keep apart, so that the mip levels promised do not mix them; half as many from the border.
[[nodiscard]] int chart_padding(const AtlasOptions& options);

/// Lays charts of these sizes, m, as large as the atlas allows, or the atlas as small as the density allows.
/// Throws std::invalid_argument when they do not fit.
[[nodiscard]] ChartLayout lay_out_charts(std::span<const Vec2d> sizes, const AtlasOptions& options);

}  // namespace penumbra
