#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Form factors from points to what they see of a convex polygon behind convex occluders, exactly, many points at once.
///
/// Lambert's edge sum (1760) over the outline of the visible part: each source edge where no occluder covers it, and
/// each occluder edge, backwards, where it stands before the source and no other occluder covers it. On an edge the
/// stretch inside a convex outline is one interval, so every point of a vector takes the same steps: no polygons are
/// cut. The union of the occluders is exact; occluders must be in general position (see OccluderPolygons).
///
/// One object a thread: evaluate() uses its scratch memory.
class VisibleFragments {
 public:
  /// Points are evaluated in groups of this many.
  static constexpr std::size_t group = 8;

  VisibleFragments();
  ~VisibleFragments();

  /// @param polygon convex, counter-clockwise seen from the points, wholly in front of their horizon. Forgets the
  /// occluders.
  void set_source(std::span<const Vec3d> polygon);
  /// @param polygon convex, counter-clockwise around `plane.normal`, wholly in front of the points' horizon and of
  /// the source's plane.
  void add_occluder(std::span<const Vec3d> polygon, const Plane3& plane);
  [[nodiscard]] std::size_t occluder_count() const { return planes_.size(); }

  /// @param x, y, z the points, all in front of the source's plane; `count` is a multiple of `group`.
  /// @param normal unit, of the element at each point. @param factors receives the form factors (0..1).
  void evaluate(const double* x, const double* y, const double* z, std::size_t count, const Vec3d& normal,
                double* factors);

  /// How the kernel sees its input: corner k of the source is corners[k]; occluder k has the corners
  /// [offsets[k], offsets[k + 1]).
  struct Input {
    std::span<const Vec3d> source;
    std::span<const Vec3d> corners;
    std::span<const std::uint32_t> offsets;
    std::span<const Plane3> planes;
  };

 private:
  std::vector<Vec3d> source_, corners_;
  std::vector<std::uint32_t> offsets_{0};
  std::vector<Plane3> planes_;
  std::vector<double> scratch_;
  std::vector<std::uint32_t> active_;
};

}  // namespace penumbra
