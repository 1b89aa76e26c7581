#include "penumbra/baking/texel_solution.h"

#include <algorithm>

#include "penumbra/baking/texel_direct.h"

namespace penumbra {
namespace {

constexpr std::uint32_t fewest_rays = 64, most_rays = 1024;
/// Rays that are remembered, four bytes each.
constexpr double most_remembered = 32e6;

std::uint32_t rays_a_cell(std::size_t texels, double noise) {
  const double cells = std::min(static_cast<double>(texels), 4e5);
  std::uint32_t rays = fewest_rays;
  while (rays < most_rays && rays * noise < 0.6 && 2 * rays * cells <= most_remembered) rays *= 2;
  return rays;
}

}  // namespace

TexelSolution::TexelSolution(const LightmapAtlas& atlas, const Texels& texels, const Options& options,
                             const Progress& progress)
    : tracer_(atlas.scene),
      map_(atlas, texels),
      space_(std::make_unique<AtlasSpace>(map_, tracer_)),
      straight_(atlas, tracer_,
                {.front_sides_only = options.front_sides_only, .opaque_shadows = options.opaque_shadows}),
      order_(texels_in_blocks(map_)),
      points_(tracer_, map_, *space_, progress),
      rays_(points_, *space_, straight_.lamps()) {
  direct_ = direct_light_of_texels(straight_, points_, *space_, map_, order_, progress);
  front_sides_only_ = options.front_sides_only;
  progress.tell("interreflection", 0);
  cells_ = std::make_unique<LightCells>(rays_, *space_, straight_, order_, direct_,
                                        LightCells::Options{.rays = rays_a_cell(texels.count(), options.noise),
                                                            .front_sides_only = options.front_sides_only,
                                                            .seed = options.seed},
                                        progress);
  cells_->solve(progress);
  progress.tell("interreflection", 1);
  partial_ = cells_->is_partial() || progress.stop_requested();
}

}  // namespace penumbra
