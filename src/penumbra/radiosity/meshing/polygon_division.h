#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A cell of a divided polygon: its corners, oriented as the polygon. Valid during the call only.
using PolygonCellSink = std::function<void(std::span<const Vec3d> cell)>;

/// Cuts a convex polygon into cells of good shape whose edges are at most `size` (m; 0 or infinite: one cell).
///
/// Quadrilaterals whose opposite sides are of like length become bilinear grids of ceil(longer side / size) cells each
/// way (a rectangle: a regular grid), triangles n^2 similar triangles with n = ceil(longest edge / size). Long thin
/// ones and polygons of more corners are halved across their longest axis of inertia until they fit. The points on an
/// edge depend on that edge and the count along it alone, and a reversed polygon gives the same cells reversed, bit by
/// bit: neighbours meet corner to corner where they divide their edge alike, and the two sides of a plate stay
/// coincident.
void divide_polygon(std::span<const Vec3d> polygon, double size, const PolygonCellSink& sink);

/// How many cells `divide_polygon` makes.
[[nodiscard]] std::size_t count_cells(std::span<const Vec3d> polygon, double size);

/// Cuts a convex polygon in two by the line through its centre of area across its longest axis of inertia; a corner
/// close to the line is taken in its place. The cells have the orientation of the polygon.
void halve_polygon(std::span<const Vec3d> polygon, std::vector<Vec3d>& first, std::vector<Vec3d>& second);

}  // namespace penumbra
