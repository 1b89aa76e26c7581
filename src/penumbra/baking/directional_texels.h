#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/baking/texel_solution.h"
#include "penumbra/parallel/progress.h"

namespace penumbra {

struct DirectionalTexelsOptions {
  std::uint32_t rays = 512;         ///< a texel, 16 or more
  std::uint32_t lamp_samples = 32;  ///< shadow rays to each lamp
  std::uint64_t seed = 0;
  Progress progress{};
};

/// A directional lightmap: spherical harmonics, bands 0 and 1, of the radiance that comes to the front of each texel.
struct DirectionalTexels {
  /// [(texel * 4 + coefficient) * 3 + band], W/(m^2 sr); coefficients as spherical_harmonics() orders them, in world
  /// axes. Nothing comes from below the surface. 0 for buried texels, and for those not reached when stopped early.
  std::vector<float> coefficients;
  bool partial = false;
};

/// By even rays over the hemisphere and points of lamps. Throws std::invalid_argument for options out of range.
[[nodiscard]] DirectionalTexels bake_directional_texels(const TexelSolution& solution,
                                                        const DirectionalTexelsOptions& options = {});

}  // namespace penumbra
