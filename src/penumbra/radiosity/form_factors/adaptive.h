#pragma once

#include <cstddef>
#include <memory>

#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// How partly hidden pairs are integrated.
enum class AdaptiveVisibility {
  /// Occluders projected and clipped exactly for many points at once, the receiver cut along shadow lines.
  clipping,
  /// Fragments in the exact order of a BSP tree, each cutting its pyramid out of the source; the receiver is halved
  /// where
  /// the estimate asks for it, as in Walton's program. Slower; shares no code with the other above Lambert's sum.
  bsp_tree,
};

struct AdaptiveOptions {
  double tolerance = 1e-4;  ///< for each row, of the sum of |error of F_ij|
  AdaptiveVisibility visibility = AdaptiveVisibility::clipping;
  std::size_t most_cells = 1 << 16;    ///< pieces that one receiver may be cut into
  bool between_surfaces_only = false;  ///< leaves out the pairs within one surface
};

/// Obstructed form factors by adaptive integration (G. N. Walton, "Calculation of Obstructed View Factors by Adaptive
/// Integration", NISTIR 6925, 2002), pair by pair.
///
/// For each pair that faces the other the polygons that may stand in between are listed by cheap tests (facing, shaft,
/// planes). Without any the factor is the exact contour integral; hidden by one of them it is 0; else the exact factor
/// from points of the smaller polygon to what they see of the other is integrated over it, in ever smaller pieces,
/// until the estimated error is within the pair's part of the tolerance. Where `most_cells` does not suffice the error
/// says so. Throws std::invalid_argument for a tolerance that is not positive.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_adaptive(const PatchMesh& mesh, const AdaptiveOptions& options);

}  // namespace penumbra
