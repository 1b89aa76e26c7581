#pragma once

#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// How often a polygon stands in doubt between two clusters of sixteen patches, over all pairs of clusters: what `auto`
/// has to look at, and what its time grows with. Estimated from some pairs, to about a fifth.
///
/// Walls and boxes merge into few polygons; on finely faceted bodies each facet counts.
[[nodiscard]] double crowding(const PatchMesh& mesh);

}  // namespace penumbra
