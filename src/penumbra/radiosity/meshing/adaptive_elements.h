#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// How elements follow the light.
struct AdaptiveMeshingOptions {
  /// About this many elements. An eighth is spent evenly, at most half on shadow lines, the rest where the irradiance
  /// asks for them; what is then left is spent on the largest.
  std::size_t element_count = 10000;
  /// Elements whose interpolated irradiance is within this share of the scene's largest are not split.
  double contrast = 1e-3;
  double element_size = 0;  ///< longest edge to begin with, m; 0: chosen from the count
  /// Shortest edge of an element, m; 0: 1/2000 of the scene's size.
  double least_size = 0;
  bool shadow_lines = true;  ///< split along D0, D1 and D2 lines first (see ShadowLine)
  PatchSides sides = PatchSides::both;
  int shape_segments = 32;
  Progress progress{};
};

/// Elements, each a piece of a patch: patches shoot, elements receive (Cohen, Greenberg, Immel & Brock 1986).
struct AdaptiveMesh {
  PatchMesh patches;                  ///< the input polygons
  PatchMesh elements;                 ///< each one patch and one surface, textures averaged
  std::vector<std::uint32_t> parent;  ///< the patch of each element
  std::size_t shadow_lines = 0;       ///< lines found
  bool partial = false;               ///< stopped from outside: coarser than asked for
  std::vector<std::string> warnings;
};

/// The faces of a scene cut into elements where their direct irradiance from emitting faces, points and far lights
/// demands it: along shadow lines first, then, worst first, where the irradiance in the middle of an element and of its
/// edges departs from what its corners' interpolate to, halved in the direction that departs most. Irradiance is exact
/// (LampIrradiance). A scene without lamps is divided evenly. Both sides of a plate are divided alike. Throws
/// std::invalid_argument as make_uniform_elements does.
[[nodiscard]] AdaptiveMesh make_adaptive_elements(const Scene& scene, const AdaptiveMeshingOptions& options = {});

}  // namespace penumbra
