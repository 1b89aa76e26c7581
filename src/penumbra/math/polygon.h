#pragma once

#include <span>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

// Planar polygons as spans of corners, in order, without repeating the first. Counter-clockwise seen from the front:
// the normal points to the viewer. Lengths in metres, areas in m^2. Nothing here allocates except into `out` vectors,
// whose capacity is reused.

/// The oriented plane dot(normal, p) = offset. `normal` is unit; its side is the front, the side of the half-space.
struct Plane3 {
  Vec3d normal{0, 0, 1};
  double offset = 0;

  /// Signed distance, > 0 in front.
  [[nodiscard]] double distance(const Vec3d& p) const { return dot(normal, p) - offset; }
};

/// Twice the vector area (Newell's sum): its direction is the front normal, its length twice the area. Corners are
/// taken relative to the first, so a far origin costs no digits. Zero for fewer than three corners.
[[nodiscard]] Vec3d newell_vector(std::span<const Vec3d> polygon);

/// Area (of the projection along the Newell normal when not quite planar).
[[nodiscard]] double polygon_area(std::span<const Vec3d> polygon);

/// Unit Newell normal; zero for a polygon without area.
[[nodiscard]] Vec3d polygon_normal(std::span<const Vec3d> polygon);

/// Centre of area; the mean of the corners for a polygon without area. @pre at least one corner.
[[nodiscard]] Vec3d polygon_centroid(std::span<const Vec3d> polygon);

/// The plane through the centroid with the Newell normal.
[[nodiscard]] Plane3 polygon_plane(std::span<const Vec3d> polygon);

/// Length of the bounding box's diagonal: the size that tolerances refer to.
[[nodiscard]] double polygon_size(std::span<const Vec3d> polygon);

/// Largest distance of a corner from the plane with the Newell normal through the mean of the corners.
[[nodiscard]] double planarity_error(std::span<const Vec3d> polygon);

/// True when no inner angle is reflex (beyond rounding) and the outline turns round once. Straight angles are convex.
[[nodiscard]] bool is_convex(std::span<const Vec3d> polygon);

/// True when two edges of the outline cross or overlap, or a corner lies on another edge, judged in the projection
/// along the dominant axis of the Newell normal. O(n^2). Consecutive equal corners must have been removed.
[[nodiscard]] bool is_self_intersecting(std::span<const Vec3d> polygon);

/// True when `point`, projected onto the plane of the convex `polygon`, lies inside or on its outline.
[[nodiscard]] bool convex_contains(std::span<const Vec3d> polygon, const Vec3d& point);

/// Sutherland & Hodgman 1974: the part of `polygon` in the half-space distance >= -tolerance. `out` receives it, empty
/// when no corner is farther in front than `tolerance`. Corners within `tolerance` of the plane count as lying on it
/// and are kept bit by bit; new corners stand on the plane itself. For concave polygons the pieces stay joined by edges
/// that run back on themselves and cancel in contour integrals.
/// @pre `out` does not hold `polygon` itself.
void clip_polygon(std::span<const Vec3d> polygon, const Plane3& half_space, double tolerance, std::vector<Vec3d>& out);

/// Orthogonal projection of each corner onto a plane.
void project_polygon(std::span<const Vec3d> polygon, const Plane3& plane, std::vector<Vec3d>& out);

/// Coordinates of each corner in the frame (x_axis, y_axis) with its origin at `origin`.
void project_polygon_2d(std::span<const Vec3d> polygon, const Vec3d& origin, const Vec3d& x_axis, const Vec3d& y_axis,
                        std::vector<Vec2d>& out);

}  // namespace penumbra
