#include "penumbra/baking/texel_solution.h"

#include "penumbra/baking/texel_direct.h"

namespace penumbra {

TexelSolution::TexelSolution(const LightmapAtlas& atlas, const Texels& texels, bool front_sides_only,
                             std::uint64_t seed, const Progress& progress)
    : tracer_(atlas.scene),
      map_(atlas, texels),
      space_(std::make_unique<AtlasSpace>(map_, tracer_)),
      straight_(atlas, front_sides_only),
      order_(texels_in_blocks(map_)),
      points_(tracer_, map_, *space_),
      rays_(points_, straight_.lamps()) {
  direct_ = direct_light_of_texels(straight_, points_, *space_, map_, order_, progress);
  progress.tell("interreflection", 0);
  cells_ =
      std::make_unique<LightCells>(rays_, *space_, straight_, order_, direct_,
                                   LightCells::Options{.front_sides_only = front_sides_only, .seed = seed}, progress);
  iterations_ = cells_->solve(progress);
  progress.tell("interreflection", 1);
  partial_ = cells_->is_partial() || progress.stop_requested();
}

}  // namespace penumbra
