#pragma once

#include "penumbra/tracing/hit.h"
#include "penumbra/tracing/ray_differential.h"

namespace penumbra {

/// The share of the second colour of Material::checker_colour at a point, 0 or 1: the squares lie in the plane of the
/// two axes nearest to the surface's. @param size of a square, m.
[[nodiscard]] float second_colour_share(const SurfacePoint& point, double size);

/// The same averaged over a footprint: boxes along the footprint's long axis, each integrated in closed form; together
/// they spread as the footprint does, as second moments go.
[[nodiscard]] float second_colour_share(const SurfacePoint& point, double size, const Footprint& footprint);

}  // namespace penumbra
