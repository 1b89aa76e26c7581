#pragma once

#include <string>
#include <vector>

#include "bake_arguments.h"
#include "console.h"
#include "interrupt.h"
#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/baking/texel_solution.h"
#include "penumbra/baking/texels.h"
#include "report.h"

namespace penumbra::cli {

/// The scene of a bake on its atlas.
struct UnfoldedScene {
  LightmapAtlas atlas;
  Texels texels;
  double load_seconds = 0, mesh_seconds = 0;
};

/// Reads the scene, makes triangles of exact shapes and an atlas as asked; from then on there is something to keep.
/// @param warnings gets what is to be told. Throws FileError, UsageError.
[[nodiscard]] UnfoldedScene unfold_scene(const BakeArguments& arguments, Console& console, Interrupt& interrupt,
                                         std::vector<std::string>& warnings);

/// How its light is solved. @param noise of what will be gathered, relative.
[[nodiscard]] TexelSolution::Options solution_options(const BakeArguments& arguments, double noise);

/// What a report says of an atlas.
struct AtlasFacts {
  int width = 0, height = 0;
  double texels_per_metre = 0;
  std::size_t charts = 0, triangles = 0, texels = 0;
};
[[nodiscard]] AtlasFacts facts_of(const UnfoldedScene& scene);
[[nodiscard]] Report report_on(const AtlasFacts& atlas);

}  // namespace penumbra::cli
