#pragma once

#include <vector>

#include "penumbra/radiosity/absorbing_air.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// Weighs each factor of the matrix by what the air between its two patches leaves (AbsorbingAir::between), so that
/// any solver takes the air into account. Returns for each row how much of its sum the air took: F_ij (1 - T_ij)
/// summed over j, 0..1.
std::vector<double> weaken_factors(const PatchMesh& mesh, const AbsorbingAir& air, FactorMatrix& factors);

}  // namespace penumbra
