#include "penumbra/radiosity/form_factors/crowding.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "penumbra/math/rng.h"
#include "penumbra/radiosity/form_factors/occluder_index.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/patch_clusters.h"

namespace penumbra {
namespace {

constexpr std::size_t drawn_pairs = 2048;

}  // namespace

double crowding(const PatchMesh& mesh) {
  const OccluderPolygons occluders = make_occluder_polygons(mesh);
  const OccluderIndex index(occluders);
  const PatchClusters clusters = make_patch_clusters(mesh);
  const std::size_t count = clusters.size();
  double met = 0;
  std::vector<std::uint32_t> found;
  for (std::size_t k = 0; k < drawn_pairs && count > 0; ++k) {
    // The first of a pair goes through all clusters evenly.
    const auto& a = clusters.clusters[k * count / drawn_pairs];
    const auto& b = clusters.clusters[hash_key(k) % count];
    if (index.between(a, b, found) == Sight::partial) met += static_cast<double>(found.size());
  }
  const double pairs = 0.5 * static_cast<double>(count) * static_cast<double>(count + 1);
  return pairs * met / static_cast<double>(drawn_pairs);
}

}  // namespace penumbra
