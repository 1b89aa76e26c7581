#pragma once

#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/scene/shape.h"

namespace penumbra {

/// Planar convex polygons inscribed in a shape, counter-clockwise seen from its front, world space: a disk is one
/// polygon, a cylinder `segments` rectangles, a sphere `segments` around and half as many (at least 2) from pole to
/// pole, triangles at the poles and trapezoids between. Areas are below the true ones by a share that falls as
/// 1/segments^2. Throws std::invalid_argument for fewer than 3 segments and for a Plane, which has no end.
[[nodiscard]] std::vector<std::vector<Vec3d>> shape_polygons(const Shape& shape, int segments);

}  // namespace penumbra
