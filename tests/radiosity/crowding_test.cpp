#include "penumbra/radiosity/form_factors/crowding.h"

#include <gtest/gtest.h>

#include <vector>

#include "penumbra/radiosity/form_factors/occluder_index.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/patch_clusters.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/scene/builtin_scenes.h"

namespace penumbra {
namespace {

PatchMesh elements_of(const char* scene, std::size_t count) {
  MeshingOptions meshing;
  meshing.element_count = count;
  return make_uniform_elements(make_builtin_scene(scene), meshing).mesh;
}

double counted(const PatchMesh& mesh) {
  const OccluderPolygons occluders = make_occluder_polygons(mesh);
  const OccluderIndex index(occluders);
  const PatchClusters clusters = make_patch_clusters(mesh);
  std::vector<std::uint32_t> found;
  double met = 0;
  for (std::size_t a = 0; a < clusters.size(); ++a) {
    for (std::size_t b = a; b < clusters.size(); ++b) {
      if (index.between(clusters.clusters[a], clusters.clusters[b], found) == Sight::partial)
        met += static_cast<double>(found.size());
    }
  }
  return met;
}

TEST(Crowding, IsTheCountOverAllPairs) {
  for (const char* scene : {"cornell-box", "cornell-spheres"}) {
    const PatchMesh mesh = elements_of(scene, 3000);
    const double all = counted(mesh);
    ASSERT_GT(all, 0) << scene;
    EXPECT_NEAR(crowding(mesh) / all, 1, 0.2) << scene;
  }
}

TEST(Crowding, OfAnEmptyMeshIsNone) { EXPECT_EQ(crowding(PatchMesh{}), 0); }

}  // namespace
}  // namespace penumbra
