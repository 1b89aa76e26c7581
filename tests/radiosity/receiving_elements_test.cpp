#include "penumbra/radiosity/pipeline/receiving_elements.h"

#include <gtest/gtest.h>

#include <vector>

#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "radiosity/shadow_floor.h"

namespace penumbra {
namespace {

/// The shadow floor: one patch a face, cells as patches to begin with, and the lamp's light sent.
struct LitFloor {
  Scene scene = shadow_floor::scene();
  MadePatchMesh patches = make_element_faces(scene, PatchSides::both, 8);
  AdaptiveCells cells{patches.mesh, 1e-3, 1e-3};
  std::vector<double> sent;

  LitFloor() : sent(3 * patches.mesh.patch_count(), 0) {
    for (std::uint32_t k = 0; k < cells.plates().size(); ++k) {
      const auto corners = patches.mesh.polygon(cells.plates()[k].front);
      cells.add(k, {corners.begin(), corners.end()});
    }
    cells.mark();
    for (std::size_t p = 0; p < patches.mesh.patch_count(); ++p) {
      const PatchSurface& surface = patches.mesh.surfaces[p];
      if (surface.face == 1 && !surface.back) sent[3 * p] = sent[3 * p + 2] = 1;
    }
  }
};

TEST(ReceivingElements, CutsShareOutWhatHadArrivedAndChangeNoPower) {
  LitFloor floor;
  const auto occluders = std::make_shared<const OccluderPolygons>(make_occluder_polygons(floor.patches.mesh));
  ReceivingElements elements(floor.scene, floor.patches.mesh, occluders, floor.cells, {}, {});
  const double arrives = 0.01;  // not what factors say, so that it is seen where the pieces' power comes from
  for (std::uint32_t e = 0; e < elements.size(); ++e) {
    (void)elements.receive(e, arrives * (1 + e), std::vector<double>{1, 0, 1});
  }
  const double power = elements.received_power();
  const std::size_t before = elements.size();
  for (int cuts = 0; cuts < 4; ++cuts) {
    floor.cells.mark();
    floor.cells.split_largest(2 * floor.cells.cells().size());
    elements.follow(floor.cells, floor.sent);
    EXPECT_NEAR(elements.received_power(), power, 1e-12 * power) << cuts;
  }
  EXPECT_GT(elements.size(), 10 * before);
  // On the floor, below the lamp, they share as the lamp shines: less in the middle, which the blocker hides.
  double hidden = 0, lit = 0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    EXPECT_EQ(elements.received()[3 * e + 1], 0);
    const PatchMesh& mesh = elements.mesh();
    if (mesh.surfaces[e].face != 0 || mesh.surfaces[e].back) continue;
    const double distance = length(mesh.centroids[e]);
    if (distance < 0.2) hidden = std::max(hidden, elements.received()[3 * e]);
    if (distance > 0.6 && distance < 0.8) lit = std::max(lit, elements.received()[3 * e]);
  }
  EXPECT_GT(lit, 2 * hidden);
}

}  // namespace
}  // namespace penumbra
