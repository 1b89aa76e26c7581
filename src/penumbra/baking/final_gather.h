#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/baking/light_cells.h"
#include "penumbra/parallel/progress.h"

namespace penumbra {

/// Which texels belong together when noise is judged: a chart, or all the small charts of an instance.
struct NoiseSurfaces {
  std::vector<std::uint32_t> of_chart;
  std::vector<double> mean;  ///< luminance of the irradiance, W/m^2
  double scene_mean = 0;
};
[[nodiscard]] NoiseSurfaces make_noise_surfaces(const TexelMap& map, const LightCells& cells);

struct FinalGatherOptions {
  double noise = 0.01;
  std::uint32_t fewest_rays = 64, most_rays = 4096;  ///< a texel, powers of 2
  std::uint64_t seed = 0;
};

/// What rays bring to each texel.
struct GatheredLight {
  std::vector<float> irradiance;  ///< [texel * 3 + band], W/m^2
  std::vector<float> error;       ///< estimated standard error of its luminance, W/m^2
  std::size_t rays = 0;
  bool partial = false;
};

/// Gathers light from the solved cells by rays from every texel that is not buried; in groups of sixteen neighbours,
/// twice as many rays until the group's two half sets agree as well as the noise asks for, or the rays are spent.
[[nodiscard]] GatheredLight final_gather(const TexelRays& rays, const LightCells& cells, const NoiseSurfaces& surfaces,
                                         std::span<const std::uint32_t> order, const FinalGatherOptions& options,
                                         const Progress& progress);

}  // namespace penumbra
