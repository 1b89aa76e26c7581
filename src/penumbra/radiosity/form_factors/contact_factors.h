#pragma once

#include <memory>

#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// `method` itself for a mesh without PatchMesh::contacts; otherwise a method that gives patches in contact all of each
/// other (exchange = area, no error) and nothing of the rest, and leaves all other pairs to `method`. As obstructions
/// they count for both. The mesh must outlive the result.
[[nodiscard]] std::unique_ptr<FormFactorMethod> with_contacts(std::unique_ptr<FormFactorMethod> method,
                                                              const PatchMesh& mesh);

}  // namespace penumbra
