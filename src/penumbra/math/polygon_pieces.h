#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

// Cutting planar polygons into simpler ones. These functions allocate: they are for building, not for inner loops.

/// Ear clipping (Meisters 1975): n - 2 triangles of corner numbers, oriented as the polygon. Works on simple
/// polygons, concave too, and on nearly planar ones. Corners in a straight line may give triangles without area.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(std::span<const Vec3d> polygon);

/// Convex pieces of a simple polygon as rings of corner numbers, oriented as the polygon: the triangles merged across
/// inner edges while that stays convex (Hertel & Mehlhorn 1983), at most four times the fewest possible. One ring, the
/// polygon itself, when it is convex.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> convex_pieces(std::span<const Vec3d> polygon);

/// What remains of convex `polygon` when the coplanar convex `hole` is cut out, as disjoint convex pieces that have
/// the orientation of `polygon`; `hole` may have either orientation and may stick out.
[[nodiscard]] std::vector<std::vector<Vec3d>> subtract_convex(std::span<const Vec3d> polygon,
                                                              std::span<const Vec3d> hole);

}  // namespace penumbra
