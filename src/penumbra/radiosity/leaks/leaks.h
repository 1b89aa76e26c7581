#pragma once

#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/scene/finding.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// Lengths, relative to the diagonal of the scene.
struct LeakOptions {
  /// Surfaces this near meet: what single precision cannot tell apart.
  double touching = 2e-7;
  /// A gap wider than this (or than a twentieth of its edge) is an opening, not a crack.
  double widest_crack = 5e-3;
};

/// Where light would get past surfaces that look closed, or meet a side that it should not: holes, enclosures without a
/// side, cracks between edges that should meet, corners beside their neighbour's edge, neighbours that face opposite
/// ways, and faces that lie over each other. Like places between the same objects are put together, the worst first
/// named.
///
/// Edges that another face touches all along are closed (corners within edges, boxes that stand on a floor), and so are
/// the outlines of sheets. The side through which a camera of the scene looks in counts as deliberate. Exact shapes
/// have no seams and are not looked at. Stopped early, the findings are those of the work done.
[[nodiscard]] std::vector<Finding> find_leaks(const Scene& scene, const LeakOptions& options = {},
                                              const Progress& progress = {});

}  // namespace penumbra
