#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "penumbra/baking/texel_solution.h"
#include "penumbra/math/bounds.h"
#include "penumbra/parallel/progress.h"

namespace penumbra {

struct ProbeOptions {
  Bounds bounds;                      ///< of the grid; empty: the scene's, with probes in the middles of even cells
  std::array<int, 3> count{4, 4, 4};  ///< along x, y and z; 1 or more
  int rings = 24;                     ///< of rays: 2 rings^2 rays a probe; 3 to 64
  std::uint32_t lamp_samples = 64;    ///< shadow rays to each lamp
  std::uint64_t seed = 0;
  Progress progress{};
};

/// What light comes to points in space from all around, for things that move: spherical harmonics of the incoming
/// radiance up to band 2, in the order of spherical_harmonics().
struct ProbeGrid {
  std::array<int, 3> count{};
  std::vector<Vec3d> positions;         ///< x fastest, then y, then z
  std::vector<float> coefficients;      ///< [(probe * 9 + coefficient) * 3 + band], W/(m^2 sr)
  std::vector<std::uint8_t> is_inside;  ///< 1: most rays met backs at first, so the probe lies inside solid matter
  bool partial = false;

  [[nodiscard]] std::array<Rgb, 9> radiance(std::size_t probe) const;
};

/// Lamps by points on them, everything else by rays to the solved cells: a product rule of Gauss nodes along the
/// height and even steps around, turned at random, exact for light that varies as harmonics themselves do.
/// Throws std::invalid_argument for options out of range, and without bounds for a scene that has none.
[[nodiscard]] ProbeGrid bake_probes(const TexelSolution& solution, const ProbeOptions& options = {});

}  // namespace penumbra
