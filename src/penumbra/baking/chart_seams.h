#pragma once

#include <array>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// An edge of the surface that two charts share: where each has it, texels. Both lines run the same way in space.
struct ChartSeam {
  std::array<Vec2d, 2> one, other;
};

/// The edges where charts end and another's begins, without a crease and without a wall between: their fronts turn by
/// at most `crease_angle`, rad, or the mesh is smooth there (its vertex normals agree). Ends are the same within a
/// millionth of the scene's size, whatever objects they belong to.
[[nodiscard]] std::vector<ChartSeam> find_seams(const LightmapAtlas& atlas, double crease_angle);

}  // namespace penumbra
