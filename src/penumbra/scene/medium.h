#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/spectrum.h"

namespace penumbra {

/// Density in the cells of a regular grid: values at their centres, trilinear between them, the outermost half cell
/// even.
struct DensityGrid {
  std::array<std::uint32_t, 3> cells{0, 0, 0};  ///< along x, y and z
  std::vector<float> values;  ///< >= 0, dimensionless; that of cell (x, y, z) at (x * cells[1] + y) * cells[2] + z
  Bounds box;                 ///< world, m; nothing outside
};

/// A participating medium: what takes light away between surfaces and scatters it, such as fog, smoke or milk.
struct Medium {
  std::string name;
  Rgb absorption{0.0F};         ///< sigma_a, 1/m
  Rgb scattering{0.0F};         ///< sigma_s, 1/m
  float asymmetry = 0;          ///< mean cosine g of Henyey & Greenstein's phase function, -1 < g < 1; > 0 forward
  std::optional<Bounds> box{};  ///< world, m: where it is; none: wherever it may be
  std::optional<DensityGrid> density{};  ///< multiplies both coefficients and bounds the medium by its own box

  [[nodiscard]] Rgb extinction() const { return absorption + scattering; }
  [[nodiscard]] bool scatters() const { return !is_black(scattering); }
};

/// The most media that may stand in the open air of a scene.
inline constexpr std::size_t most_media_in_air = 8;

}  // namespace penumbra
