#pragma once

#include <span>

#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// A solution as a scene that any viewer shows as it is: the fronts of the elements as triangles with smooth vertex
/// colours and one unlit, double-sided material; a mesh for each object, with its name and what else was said of it.
///
/// Irradiance is interpolated as ShadingMesh does and multiplied by each element's own reflectance; emission is added.
/// Vertices between elements of different reflectance or emission are doubled, so that borders of colours stay sharp.
/// @param irradiance of the elements, [element * 3 + band], W/m^2. @param scale from radiosity to colour; colours are
/// linear and cut at 1, as glTF asks. @param scene whose elements they are. @param lamps those of the scene: their own
/// light is then exact at the vertices, see sharp_irradiance(); none: all light is blended.
[[nodiscard]] Scene vertex_coloured_scene(const PatchMesh& elements, std::span<const double> irradiance, double scale,
                                          const Scene& scene, const LampIrradiance* lamps = nullptr);

}  // namespace penumbra
