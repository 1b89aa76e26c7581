#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/radiosity/form_factors/silhouette.h"

namespace penumbra {

/// Form factors from points to what they see of a convex polygon behind occluders, exactly, many points at once.
///
/// Lambert's edge sum (1760) over the outline of the visible part: each source edge where nothing covers it, and each
/// edge of the occluders' silhouette, backwards, where it stands before the source and nothing else covers it. How many
/// polygons cover a corner of the source is a winding number (Sunday 2001), and it changes wherever a way from there
/// crosses the silhouette: no polygons are cut, and every point of a vector takes the same steps. The union of the
/// occluders is exact; they must be in general position (see OccluderPolygons).
///
/// One object a thread: evaluate() uses its scratch memory.
class VisibleFragments {
 public:
  /// Points are evaluated in groups of this many.
  static constexpr std::size_t group = 8;

  /// @param polygon convex, counter-clockwise seen from the points, wholly in front of their horizon.
  void set_source(std::span<const Vec3d> polygon) { source_.assign(polygon.begin(), polygon.end()); }

  /// @param silhouette of what is in front of the points' horizon and of the source's plane.
  /// @param x, y, z the points, all in front of the source's plane; `count` is a multiple of `group`.
  /// @param normal unit, of the element at each point. @param factors receives the form factors (0..1),
  /// @param open_factors those without the silhouette.
  void evaluate(const Silhouette& silhouette, const double* x, const double* y, const double* z, std::size_t count,
                const Vec3d& normal, double* factors, double* open_factors);

  /// How the kernel sees its input.
  struct Input {
    std::span<const Vec3d> source;
    std::size_t first_corner;  ///< of the source, well above the horizon
    std::span<const Vec3d> vertices;
    std::span<const Silhouette::Edge> edges;
    std::span<const Silhouette::Turning> turning;
    std::span<const Plane3> planes;
    const Silhouette::Reference* reference;  ///< nullptr: the contours close
  };

 private:
  std::vector<Vec3d> source_;
  std::vector<double> scratch_;
  std::vector<std::uint32_t> before_;
};

}  // namespace penumbra
