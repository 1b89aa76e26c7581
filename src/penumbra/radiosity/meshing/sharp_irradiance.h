#pragma once

#include <span>
#include <vector>

#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/shading_mesh.h"

namespace penumbra {

/// A shading mesh whose vertices have their own direct light.
struct SharpIrradiance {
  ShadingMesh mesh;                 ///< vertices are doubled where light jumps
  std::vector<double> at_vertices;  ///< [vertex * 3 + band], W/m^2, >= 0
};

/// Irradiance at the vertices of a shading mesh: what comes straight from the lamps exactly, by its value there, and
/// the rest, which is smooth, blended from the elements. So shadows are as crisp as the mesh allows, where values
/// blended from elements would smear them over the width of one or two.
///
/// At a vertex of jumping light (a point light's shadow, a contact) each element's own side counts: the vertex is
/// doubled when its elements disagree by more than 2 % of the brightest.
/// @param irradiance of the elements from everywhere, [element * 3 + band], W/m^2. @param shading of the same elements.
[[nodiscard]] SharpIrradiance sharp_irradiance(const LampIrradiance& light, const PatchMesh& elements,
                                               const ShadingMesh& shading, std::span<const double> irradiance);

/// What is left of the elements' irradiance without the lamps' own light, [element * 3 + band], W/m^2; may fall below 0
/// by the rounding of means.
[[nodiscard]] std::vector<double> without_lamps(const LampIrradiance& light, const PatchMesh& elements,
                                                std::span<const double> irradiance);

}  // namespace penumbra
