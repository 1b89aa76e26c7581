#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"

namespace penumbra {

/// The edges at which something that stands between two polygons may begin or end to hide, as the points of one of
/// them, the receiver, see it.
///
/// Each polygon turns its corners counter-clockwise towards its front. Seen from a point, it covers the directions on
/// the left of its edges when the point is in front of it and those on their right when it is behind: its *sign* is +1
/// or -1. An edge's *step* is the sum of the signs of the polygons that have it in its direction less that of those
/// that have it reversed: how many more polygons cover the left of the edge than the right, if the rest is left out.
/// Inside a surface, where neighbours show the same side, steps vanish and so do the edges: what is left is the
/// silhouette, and the number of polygons that cover a direction is the winding number of its steps.
///
/// Edges that no line from the receiver to the source passes do not matter and are dropped. Without them the contours
/// need not close: how many polygons cover a direction is counted once, on one *reference* line, and known for another
/// by the edges that are passed on the way from one line to the other.
///
/// One object a thread: build() keeps scratch memory.
class Silhouette {
 public:
  struct Edge {
    std::uint32_t from = 0, to = 0;     ///< into vertices
    double step = 0;                    ///< of the polygons whose front or back all points of the receiver see
    std::uint32_t first = 0, last = 0;  ///< into turning(): the others
    bool left_of = false;               ///< the reference line passes on its left
    double reference_step = 0;          ///< of the polygons that are counted on it
  };
  /// A polygon whose plane cuts through the receiver: its sign depends on the point.
  struct Turning {
    std::uint32_t plane = 0;  ///< into planes()
    double direction = 0;     ///< +1 or -1: as the edge, or reversed
  };
  /// One edge of an occluder, from a corner to the next.
  struct Rim {
    std::uint32_t occluder = 0, corner = 0;
  };
  /// What stands between, clear above the planes of receiver and source: of its edges only those that a line between
  /// the two may pass.
  struct Surface {
    std::span<const Rim> rims;
    std::span<const std::uint32_t> polygons;  ///< all those that may cover the reference line
  };
  /// The line on which the covering polygons were counted, from inside the receiver to inside the source.
  struct Reference {
    Vec3d from{0}, to{0};
    double covering = 0;
  };

  /// The parts of some occluders that are in front of both planes.
  /// @param receiver its points' corners.
  void build(const OccluderPolygons& occluders, std::span<const std::uint32_t> blockers,
             std::span<const Vec3d> receiver, const Plane3& receiver_plane, std::span<const Vec3d> source,
             const Plane3& source_plane);
  /// A surface.
  void build(const OccluderPolygons& occluders, const Surface& surface, std::span<const Vec3d> receiver,
             const Plane3& receiver_plane, std::span<const Vec3d> source, const Plane3& source_plane);

  /// Starts anew without occluders.
  void clear();
  /// Adds a polygon that shares nothing with others. @pre in front of the receiver's horizon and of the source.
  void add_polygon(std::span<const Vec3d> polygon, const Plane3& plane);

  /// Polygons of which something is left.
  [[nodiscard]] std::size_t polygon_count() const { return polygon_count_; }
  [[nodiscard]] std::span<const Vec3d> vertices() const { return vertices_; }
  [[nodiscard]] std::span<const Edge> edges() const { return edges_; }
  [[nodiscard]] std::span<const Turning> turning() const { return turning_; }
  [[nodiscard]] std::span<const Plane3> planes() const { return planes_; }
  /// Where the covering polygons were counted; nullptr: the contours close.
  [[nodiscard]] const Reference* reference() const { return has_reference_ ? &reference_ : nullptr; }

 private:
  static constexpr std::uint32_t none = OccluderPolygons::none;
  struct Corner {
    std::uint32_t vertex;
    std::uint32_t edge;  // the occluders' edge to the next corner, or none where a plane cut
  };
  /// The edges that end in a vertex, the first two of them.
  struct Meeting {
    std::uint32_t count = 0;
    std::array<std::uint32_t, 2> edges{};
  };
  /// A map from small numbers that forgets all at once.
  struct Memory {
    std::vector<std::uint32_t> value, age;
    std::uint32_t now = 0;
    void forget(std::size_t size);
    std::uint32_t& at(std::uint32_t key, std::uint32_t otherwise);
  };

  void start(const OccluderPolygons& occluders, std::span<const std::uint32_t> polygons);
  void add_blockers(const OccluderPolygons& occluders, std::span<const std::uint32_t> blockers,
                    std::span<const Vec3d> receiver, const Plane3& horizon, const Plane3& source);
  void add_rim(const OccluderPolygons& occluders, const Rim& rim, std::span<const Vec3d> receiver,
               const Plane3& horizon, const Plane3& source);
  void add_side(std::uint32_t edge, double direction, const Plane3& plane, double sign, bool turns, double slack);
  void count_covering(const OccluderPolygons& occluders, std::uint32_t k);
  void finish();
  void find_sides_of_reference();
  [[nodiscard]] double winding_number(const Vec3d& up) const;
  void drop_edges_aside(std::span<const Vec3d> receiver, std::span<const Vec3d> source);
  std::uint32_t vertex(const OccluderPolygons& occluders, std::uint32_t v, const Plane3& horizon, const Plane3& source,
                       double slack);
  void clip(int plane);
  std::uint32_t cut(int plane, std::uint32_t edge, std::uint32_t a, std::uint32_t b);
  std::uint32_t turning_plane(const Plane3& plane, double slack);
  void add_sides(const Plane3& plane, double slack, std::span<const Vec3d> receiver);
  void assign_turning_polygons();
  void join_straight_edges();
  void join_coinciding_edges();
  void drop_inner_edges();

  std::size_t polygon_count_ = 0;
  bool has_reference_ = false;
  double slack_ = 0;
  Reference reference_;
  std::vector<Vec3d> vertices_;
  std::vector<Edge> edges_;
  std::vector<Turning> turning_;
  std::vector<Plane3> planes_;

  std::vector<std::array<double, 2>> heights_;  // per vertex: over the receiver's and the source's plane
  std::vector<Corner> ring_, clipped_;
  std::vector<std::pair<std::uint32_t, Turning>> pending_;  // edge, polygon
  std::vector<Meeting> meeting_;
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>> by_ends_;  // ends, edge
  std::vector<std::uint32_t> used_;
  std::vector<std::uint64_t> aside_;  // per vertex: the sides of source and receiver outside of which it is
  std::vector<Vec3d> moved_;
  Memory vertex_of_, edge_of_;
  std::array<Memory, 2> cut_of_;
};

}  // namespace penumbra
