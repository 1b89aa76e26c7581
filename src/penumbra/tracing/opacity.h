#pragma once

#include <cstdint>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// Opacity of a surface at texture coordinates, 0..1, for alpha masks and blends: base alpha x texture x vertex alpha.
[[nodiscard]] float surface_alpha(const Scene& scene, const Material& material, const Vec2f (&uv)[2],
                                  float vertex_alpha);

/// Whether a triangle stops rays at a point: false in the holes of AlphaMode::mask, true everywhere else.
/// @param barycentric weights of vertices 1 and 2.
[[nodiscard]] bool is_solid(const Scene& scene, const Mesh& mesh, std::uint32_t triangle, const Vec2d& barycentric);

}  // namespace penumbra
