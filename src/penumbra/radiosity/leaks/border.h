#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/leaks/face_net.h"
#include "penumbra/radiosity/leaks/triangle_tree.h"

namespace penumbra {

/// What lies beyond an edge at which a face ends and no other face shares.
enum class BorderKind {
  closed,  ///< another face touches it all along: a corner within an edge, a box that stands on a floor
  gap,     ///< another face lies beyond it, not quite touching
  beside,  ///< another face runs along it, off to the side, such as the ceiling over the rim of a lamp
  open,    ///< nothing near
};

/// How a gap runs along its edge.
enum class GapShape {
  even,   ///< about as wide all along: two edges side by side
  wedge,  ///< it closes at one end
  tent,   ///< it closes at both ends: a corner beside the edge
};

/// An edge of one face alone, or the part of it between corners of others that lie on it.
struct BorderEdge {
  std::uint32_t from = 0, to = 0;  ///< vertices, as its face runs through it
  std::uint32_t face = 0;
  BorderKind kind = BorderKind::open;
  double gap = 0;               ///< the widest, m
  Vec3d place{0};               ///< where the gap is widest
  std::uint32_t neighbour = 0;  ///< the face across the gap
  GapShape shape = GapShape::even;
};

struct BorderOptions {
  double touching = 0;    ///< m: surfaces this near meet
  double widest_gap = 0;  ///< m: beyond it a gap is an opening
};

/// The border edges of a net, judged at points along them: an edge is closed where another face touches it, and has a
/// gap where its face, prolonged, would run into another face before long.
[[nodiscard]] std::vector<BorderEdge> find_border(const FaceNet& net, const TriangleTree& tree,
                                                  const BorderOptions& options, const Progress& progress);

/// Which way a face extends from one of its edges: unit, in the face, across the edge.
[[nodiscard]] Vec3d inward(const FaceNet& net, const BorderEdge& edge);

}  // namespace penumbra
