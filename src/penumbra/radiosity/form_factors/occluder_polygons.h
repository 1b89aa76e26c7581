#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/vec.h"
#include "penumbra/radiosity/form_factors/convex_bodies.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// Convex polygons that hide what lies behind them, from either side.
///
/// Corners are vertices that neighbours share. Each vertex is moved at random by about 1e-8 of the size of its smallest
/// polygon, so that no edge lies exactly on another or on one of a patch: then the contours of what is hidden close
/// without special cases (simulation of general position). `slack` bounds that motion: what lies within it of a plane
/// counts as lying on it.
struct OccluderPolygons {
  static constexpr std::uint32_t none = 0xffffffffU;

  /// A side of one or more polygons, between two vertices.
  struct Edge {
    std::uint32_t from = 0, to = 0;           ///< vertices, from < to
    std::uint32_t left = none, right = none;  ///< the polygon that has it from `from` to `to`, and reversed
    bool simple = true;                       ///< at most one on either side
    bool flat = false;                        ///< one on either side, both in one oriented plane
  };

  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> corner_offsets{0};
  std::vector<Vec3d> corners;                  ///< counter-clockwise around the plane's normal
  std::vector<std::uint32_t> corner_vertices;  ///< into vertices
  std::vector<std::uint32_t> corner_edges;     ///< the edge from a corner to the next, into edges
  std::vector<Edge> edges;
  std::vector<Plane3> planes;
  std::vector<Bounds> bounds;
  std::vector<double> slack;        ///< m
  std::vector<std::uint32_t> body;  ///< the convex solid that it bounds, or ConvexBodies::no_body
  ConvexBodies bodies;

  [[nodiscard]] std::size_t size() const { return planes.size(); }
  [[nodiscard]] std::span<const Vec3d> polygon(std::size_t k) const {
    return std::span(corners).subspan(corner_offsets[k], corner_offsets[k + 1] - corner_offsets[k]);
  }
};

/// The patches of a mesh as few convex polygons: connected coplanar patches are merged when `merge` says so, plates
/// with two sides count once, and what lies on the convex hull is left out, since nothing can be behind it.
[[nodiscard]] OccluderPolygons make_occluder_polygons(const PatchMesh& mesh, bool merge = true);

}  // namespace penumbra
