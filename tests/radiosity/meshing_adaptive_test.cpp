#include "penumbra/radiosity/meshing/adaptive_elements.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/face_cells.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/shading_mesh.h"
#include "penumbra/radiosity/meshing/shadow_lines.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/scene/builtin_scenes.h"
#include "radiosity/scene_makers.h"
#include "radiosity/shadow_floor.h"

namespace penumbra {
namespace {

double total_area(const PatchMesh& mesh, bool back) {
  double sum = 0;
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    if (mesh.surfaces[e].back == back) sum += mesh.areas[e];
  }
  return sum;
}

TEST(LampIrradiance, MatchesTheClosedFormBehindABlocker) {
  const Scene scene = shadow_floor::scene();
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::front, 8);
  const LampIrradiance light(scene, faces.mesh);
  ASSERT_EQ(light.lamps().size(), 1U);
  const auto view = light.view(faces.mesh.polygon(0));
  int umbra = 0, penumbra = 0, lit = 0;
  Dice dice(3);
  for (int k = 0; k < 2000; ++k) {
    const Vec3d p(dice.between(-1, 1), dice.between(-1, 1), 0);
    const double exact = shadow_floor::irradiance(p), whole = shadow_floor::unhindered(p);
    EXPECT_NEAR(view.at(p).x, exact, 1e-7 * whole);  // emission is single precision
    ++(exact == 0 ? umbra : exact < whole * (1 - 1e-9) ? penumbra : lit);
  }
  EXPECT_GT(std::min({umbra, penumbra, lit}), 50);
}

TEST(LampIrradiance, ABoxHidesAsMuchAsItsFacesTogether) {
  // Six faces in the way, hidden behind one another: what is seen is what no face hides, never less than 0 or more than
  // all. From points far inside the shadow nothing, far outside everything.
  Scene scene = shadow_floor::scene(false);
  std::vector<Polygon> box;
  for (const Polygon& p : reversed(room({0.4, 0.4, 0.3}))) box.push_back(moved(p, {-0.2, -0.2, 0.5}));
  add_polygons(scene, "box", box, 0);
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::front, 8);
  const LampIrradiance light(scene, faces.mesh);
  const auto view = light.view(faces.mesh.polygon(0));
  for (double x = 0.01; x < 1; x += 0.03) {
    const Vec3d p(x, 0.07, 0);
    const double seen = view.at(p).x, whole = shadow_floor::unhindered(p);
    EXPECT_GE(seen, 0);
    EXPECT_LE(seen, whole * (1 + 1e-7));
    // The plate at the box's foot alone hides no more.
    EXPECT_LE(seen, shadow_floor::irradiance(p) + 1e-7 * whole);
    if (x < 0.15) {
      EXPECT_EQ(seen, 0);
    }
    if (x > 0.75) {
      EXPECT_NEAR(seen, whole, 1e-7 * whole);
    }
  }
}

TEST(ShadowLines, AllWedgesOfASquareLampAndASquareBlockerAreFound) {
  const Scene scene = shadow_floor::scene();
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::front, 8);
  const LampIrradiance light(scene, faces.mesh);
  // On the floor they are the lines x or y = +-0.2 * 4/3 +- 0.25 / 3.
  std::set<std::pair<int, long>> lines;  // axis, millimetres
  for (const ShadowLine& line : find_shadow_lines(light)) {
    if (line.patch != 0) continue;
    const auto& [a, b] = line.ends;
    EXPECT_NEAR(a.z, 0, 1e-12);
    const int axis = std::abs(a.x - b.x) < std::abs(a.y - b.y) ? 0 : 1;
    EXPECT_NEAR(a[axis], b[axis], 1e-9);
    lines.insert({axis, std::lround(1000 * a[axis])});
    EXPECT_EQ(line.degree, 1);
  }
  std::set<std::pair<int, long>> expected;
  for (const double edge : {-0.2, 0.2}) {
    for (const double corner : {-0.25, 0.25}) {
      for (const int axis : {0, 1}) expected.insert({axis, std::lround(1000 * (edge * 4 / 3 - corner / 3))});
    }
  }
  EXPECT_EQ(lines, expected);
}

TEST(ShadowLines, APointLightsShadowAndContactsAreJumps) {
  // A box on the floor, a point light above: the box's foot and its shadow.
  Scene scene = polygon_scene({floor_rectangle(-3, 3, -3, 3)});
  std::vector<Polygon> box;
  for (const Polygon& p : reversed(room({1, 1, 1}))) box.push_back(moved(p, {-0.5, -0.5, 0}));
  add_polygons(scene, "box", box);
  scene.lights.push_back({"lamp", PointLight{{-1.5, 0, 2}, Rgb(1)}});
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::front, 8);
  const LampIrradiance light(scene, faces.mesh);
  bool foot = false, far_shadow = false;
  for (const ShadowLine& line : find_shadow_lines(light)) {
    if (line.patch != 0) continue;
    EXPECT_EQ(line.degree, 0);
    const auto& [a, b] = line.ends;
    EXPECT_NEAR(a.z, 0, 1e-12);
    if (std::abs(a.x - 0.5) < 1e-9 && std::abs(b.x - 0.5) < 1e-9) foot = true;
    // The upper far edge at (0.5, 1) is thrown twice as far from the light: x = -1.5 + 2 * 2.
    if (std::abs(a.x - 2.5) < 1e-9 && std::abs(b.x - 2.5) < 1e-9) far_shadow = true;
  }
  EXPECT_TRUE(foot);
  EXPECT_TRUE(far_shadow);
}

TEST(FaceCells, CuttingKeepsTheAreaAndLeavesNoCellAcrossTheLine) {
  Dice dice(9);
  FaceCells face({floor_rectangle(0, 1, 0, 1)});
  for (int k = 0; k < 30; ++k) {
    const Vec3d a(dice.between(-0.2, 1.2), dice.between(-0.2, 1.2), 0), b(dice.between(0, 1), dice.between(0, 1), 0);
    face.cut_along(a, b, {0, 0, 1}, 1e-4);
    double area = 0;
    for (const auto& cell : face.cells()) {
      area += polygon_area(cell);
      EXPECT_TRUE(is_convex(cell));
      EXPECT_GT(polygon_normal(cell).z, 0);
      // The middle of the segment lies in no cell's inside.
      const Vec3d middle = 0.5 * (a + b);
      double depth = 1;
      for (std::size_t e = 0; e < cell.size(); ++e) {
        const Vec3d along = normalize(cell[(e + 1) % cell.size()] - cell[e]);
        depth = std::min(depth, cross(along, middle - cell[e]).z);
      }
      EXPECT_LT(depth, 3e-4);
    }
    EXPECT_NEAR(area, 1, 1e-12);
  }
}

TEST(AdaptiveElements, CoverTheirFacesOnBothSidesAlike) {
  AdaptiveMeshingOptions options;
  options.element_count = 1000;
  const AdaptiveMesh made = make_adaptive_elements(shadow_floor::scene(), options);
  for (const bool back : {false, true}) EXPECT_NEAR(total_area(made.elements, back), 4 + 0.25 + 0.16, 1e-9);
  ASSERT_EQ(made.parent.size(), made.elements.surface_count());
  EXPECT_LE(made.elements.surface_count(), 1000U);
  EXPECT_GT(made.elements.surface_count(), 700U);
  std::map<std::multiset<std::uint32_t>, int> sides;
  for (std::size_t e = 0; e < made.elements.patch_count(); ++e) {
    ++sides[{made.elements.patch_corners(e).begin(), made.elements.patch_corners(e).end()}];
    EXPECT_EQ(made.elements.surfaces[e].face, made.patches.face_of[made.parent[e]]);
    EXPECT_GT(dot(made.elements.normals[e], made.patches.normals[made.parent[e]]), 0.999);
  }
  for (const auto& [corners, count] : sides) EXPECT_EQ(count, 2);
}

TEST(AdaptiveElements, AreSmallWhereTheShadowEnds) {
  AdaptiveMeshingOptions options;
  options.element_count = 2000;
  options.contrast = 0;
  options.shadow_lines = false;
  options.sides = PatchSides::front;
  const AdaptiveMesh made = make_adaptive_elements(shadow_floor::scene(), options);
  double edge_area = 0, far_area = 0;
  int at_edge = 0, far = 0;
  for (std::size_t e = 0; e < made.elements.patch_count(); ++e) {
    if (made.elements.surfaces[e].face != 0) continue;
    const Vec3d c = glm::abs(made.elements.centroids[e]);
    const double r = std::max(c.x, c.y);
    if (r > 0.18 && r < 0.36) {
      edge_area += made.elements.areas[e];
      ++at_edge;
    } else if (r > 0.5) {
      far_area += made.elements.areas[e];
      ++far;
    }
  }
  ASSERT_GT(at_edge, 0);
  ASSERT_GT(far, 0);
  EXPECT_LT(edge_area / at_edge, 0.25 * far_area / far);
}

TEST(AdaptiveElements, NoneIsWithoutArea) {
  const Scene scene = make_builtin_scene("cornell-box");
  for (const std::size_t count : {3000U, 6000U, 9000U, 12000U}) {
    AdaptiveMeshingOptions options;
    options.element_count = count;
    const AdaptiveMesh made = make_adaptive_elements(scene, options);
    double total = 0, least = 1e300;
    for (const PatchSurface& s : made.elements.surfaces) {
      total += s.area;
      least = std::min(least, s.area);
    }
    double faces = 0;
    for (const PatchSurface& s : make_element_faces(scene, options.sides, options.shape_segments).mesh.surfaces)
      faces += s.area;
    EXPECT_GT(least, 0) << count;
    EXPECT_NEAR(total, faces, 1e-9 * faces) << count;
  }
}

TEST(AdaptiveElements, AnEvenlyLitSceneIsNotDividedFurtherThanItsStart) {
  // Without lamps nothing asks for more than even cells.
  AdaptiveMeshingOptions options;
  options.element_count = 600;
  const AdaptiveMesh made = make_adaptive_elements(polygon_scene(room({1, 2, 3})), options);
  EXPECT_NEAR(double(made.elements.surface_count()), 600, 120);
  EXPECT_THROW((void)make_adaptive_elements(polygon_scene(room({1, 2, 3})), {.element_count = 0}),
               std::invalid_argument);
}

TEST(AdaptiveElements, TheSameBitsOnAnyNumberOfThreadsThreaded) {
  AdaptiveMeshingOptions options;
  options.element_count = 400;
  std::vector<Vec3d> one;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const AdaptiveMesh made = make_adaptive_elements(shadow_floor::scene(), options);
    if (threads == 1) one = made.elements.corner_positions;
    EXPECT_EQ(made.elements.corner_positions, one);
  }
}

TEST(AdaptiveElements, ShadowLinesMakeTheFloorFourTimesBetterThanUniform) {
  for (const std::size_t count : {400U, 1600U}) {
    const double uniform = shadow_floor::rms_of(shadow_floor::uniform_floor(count));
    AdaptiveMeshingOptions options;
    options.element_count = count;
    options.sides = PatchSides::front;
    options.contrast = 0;
    options.shadow_lines = false;
    const PatchMesh adaptive = shadow_floor::floor_of(make_adaptive_elements(shadow_floor::scene(), options).elements);
    options.shadow_lines = true;
    const PatchMesh along_lines =
        shadow_floor::floor_of(make_adaptive_elements(shadow_floor::scene(), options).elements);
    EXPECT_LE(adaptive.patch_count(), count);
    EXPECT_LE(along_lines.patch_count(), count);
    const double by_gradient = shadow_floor::rms_of(adaptive), by_lines = shadow_floor::rms_of(along_lines);
    EXPECT_LT(by_gradient, 0.5 * uniform) << count;
    EXPECT_LT(by_lines, uniform / 8) << count;  // four times is asked for
    RecordProperty("rms_uniform_" + std::to_string(count), std::to_string(uniform));
    RecordProperty("rms_adaptive_" + std::to_string(count), std::to_string(by_gradient));
    RecordProperty("rms_shadow_lines_" + std::to_string(count), std::to_string(by_lines));
  }
}

}  // namespace
}  // namespace penumbra
