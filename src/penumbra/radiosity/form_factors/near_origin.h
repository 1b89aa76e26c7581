#pragma once

#include <functional>
#include <memory>

#include "penumbra/radiosity/form_factors/form_factor_method.h"

namespace penumbra {

/// The method that `make` prepares for a mesh. When the mesh is far from the origin for its size it is made for a copy
/// that is moved there (rounding in coordinates of 1e5 m hides what is 1e-4 m large), which the method then owns.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_near_origin(
    const PatchMesh& mesh, const std::function<std::unique_ptr<FormFactorMethod>(const PatchMesh&)>& make);

}  // namespace penumbra
