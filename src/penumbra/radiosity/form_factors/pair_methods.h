#pragma once

#include <memory>

#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

// The textbook's methods that look at one pair at a time; none follows the tolerance, each says its error. Whether
// something stands between is asked of one ray from centre to centre.

/// The kernel cos cos / (pi r^2) between centres times both areas (Goral et al. 1984). The error estimate is of
/// relative order (size / distance)^2.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_point(const PatchMesh& mesh);

/// The exact factor from each patch's centre to the other polygon (Nusselt 1928; Lambert's edge sum), the mean of both
/// directions. The error estimate is their difference plus what one centre leaves out.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_nusselt(const PatchMesh& mesh);

/// The exact factor of two polygons with nothing in between (the double contour integral). Where corners of the pair
/// are hidden from each other and others are not, the factor is taken as a whole or not at all by the ray from centre
/// to centre, and the error estimate is all of it.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_analytic(const PatchMesh& mesh);

}  // namespace penumbra
