#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/baking/texels.h"
#include "penumbra/parallel/progress.h"

namespace penumbra {

struct OpennessOptions {
  double distance = std::numeric_limits<double>::infinity();  ///< m: what is farther does not hide
  std::uint32_t rays = 256;                                   ///< a texel, 16 or more
  std::uint64_t seed = 0;
  Progress progress{};
};

/// Arrays are per texel.
struct TexelOpenness {
  std::vector<float> open;           ///< 0..1; 0 where buried, and where it was not reached when stopped early
  std::vector<std::uint8_t> buried;  ///< 1 where all that is seen are backs: inside solid matter
  std::size_t rays = 0;              ///< traced
  bool partial = false;
};

/// Ambient occlusion: of the projected solid angle above the front of each texel, the share (0..1) with nothing within
/// `distance`; 1 is open.
/// Throws std::invalid_argument for options out of range. @param texels of the same atlas.
[[nodiscard]] TexelOpenness openness_of_texels(const LightmapAtlas& atlas, const Texels& texels,
                                               const OpennessOptions& options = {});

}  // namespace penumbra
