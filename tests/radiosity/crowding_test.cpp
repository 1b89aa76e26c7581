#include "penumbra/radiosity/form_factors/crowding.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <vector>

#include "penumbra/radiosity/form_factors/occluder_index.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/patch_clusters.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
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

struct Lit {
  std::unique_ptr<RadiositySetup> setup;
  std::vector<double> irradiance;
};

Lit lit(const Scene& scene, double most_crowding) {
  RadiositySetupOptions options;
  options.element_count = 1000;
  options.factors.tolerance = 1e-3;
  options.most_crowding = most_crowding;
  Lit made{make_radiosity_setup(scene, options), {}};
  made.irradiance = solve(*made.setup, {}).solution.irradiance;
  return made;
}

double power_received(const Lit& lit) {
  double power = 0;
  for (std::size_t k = 0; k < lit.irradiance.size(); ++k)
    power += lit.setup->mesh.surfaces[k / 3].area * lit.irradiance[k];
  return power;
}

// Single elements are grainy, since few rays meet a small lamp; all together receive what exact factors give them.
TEST(Crowding, BeyondTheMostAllowedBringsRaysAndTheSamePower) {
  const Scene scene = make_builtin_scene("cornell-box");
  const Lit exact = lit(scene, std::numeric_limits<double>::infinity()), cast = lit(scene, 0);
  EXPECT_EQ(exact.setup->form_factors, "auto");
  EXPECT_EQ(cast.setup->form_factors, "ray-cast");
  EXPECT_EQ(cast.setup->warnings.size(), exact.setup->warnings.size() + 1);
  EXPECT_NEAR(power_received(cast) / power_received(exact), 1, 0.01);
}

TEST(Crowding, IsNotAskedForByAnotherMethod) {
  RadiositySetupOptions options;
  options.element_count = 100;
  options.form_factors = "point";
  options.most_crowding = 0;
  EXPECT_EQ(make_radiosity_setup(make_builtin_scene("cornell-box"), options)->form_factors, "point");
}

TEST(Crowding, OfAnEmptyMeshIsNone) { EXPECT_EQ(crowding(PatchMesh{}), 0); }

}  // namespace
}  // namespace penumbra
