#include "penumbra/radiosity/patch_mesh.h"

#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>
#include <string>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

Scene scene_of(const std::string& name, const std::vector<Polygon>& faces) {
  Scene scene;
  scene.materials.emplace_back();
  add_polygons(scene, name, faces);
  return scene;
}

PolygonModel model_of(const std::vector<Polygon>& faces) {
  PolygonModel model;
  for (const Polygon& face : faces) {
    ModelPolygon polygon;
    for (const Vec3d& p : face) {
      polygon.corners.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.push_back(p);
    }
    polygon.name = "s" + std::to_string(model.polygons.size() + 1);
    polygon.place = "line " + std::to_string(10 + model.polygons.size());
    model.polygons.push_back(polygon);
  }
  return model;
}

/// The sentence that making a mesh ends with.
std::string refusal(const auto& input, const PatchMeshOptions& options = {}) {
  try {
    (void)make_patch_mesh(input, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << '"' << text << "\" does not say \"" << part << '"';
}

const Polygon el{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};

TEST(PatchMesh, ARoomHasSixRowsAndEightVertices) {
  const auto made = make_patch_mesh(scene_of("room", room({3, 4, 5})));
  const PatchMesh& mesh = made.mesh;
  EXPECT_TRUE(made.warnings.empty());
  EXPECT_EQ(mesh.patch_count(), 6U);
  EXPECT_EQ(mesh.radiating_count, 6U);
  EXPECT_EQ(mesh.surface_count(), 6U);
  EXPECT_EQ(mesh.vertices.size(), 8U);
  Vec3d closed(0);
  double area = 0;
  for (std::size_t p = 0; p < 6; ++p) {
    EXPECT_EQ(mesh.surface_of[p], p);
    EXPECT_EQ(mesh.face_of[p], p);
    EXPECT_EQ(mesh.polygon(p).size(), 4U);
    EXPECT_GT(dot(mesh.normals[p], Vec3d(1.5, 2, 2.5) - mesh.centroids[p]), 0);
    closed += mesh.areas[p] * mesh.normals[p];
    area += mesh.surfaces[p].area;
  }
  EXPECT_NEAR(length(closed), 0, 1e-13);
  EXPECT_DOUBLE_EQ(area, 94);
  EXPECT_EQ(mesh.surfaces[2].name, "room.3");
}

TEST(PatchMesh, ConcaveFacesBecomeConvexPatchesOfOneRow) {
  const PatchMesh mesh = make_patch_mesh(scene_of("L", {el})).mesh;
  ASSERT_EQ(mesh.surface_count(), 1U);
  EXPECT_EQ(mesh.patch_count(), 2U);
  EXPECT_EQ(mesh.surfaces[0].name, "L");
  EXPECT_DOUBLE_EQ(mesh.surfaces[0].area, 3);
  for (std::size_t p = 0; p < mesh.patch_count(); ++p) {
    EXPECT_TRUE(is_convex(mesh.polygon(p)));
    EXPECT_EQ(mesh.surface_of[p], 0U);
    EXPECT_EQ(mesh.normals[p], Vec3d(0, 0, 1));
  }
}

TEST(PatchMesh, InstancesStandInTheWorldAndMirrorsKeepTheFront) {
  Scene scene;
  scene.materials.emplace_back();
  const std::vector<Polygon> faces = reversed(room({1, 1, 1}));  // fronts outwards
  Mat4d mirror(1);
  mirror[0][0] = -2;
  mirror[3] = Vec4d(7, 0, 0, 1);
  add_polygons(scene, "box", faces, 0, mirror);
  const PatchMesh mesh = make_patch_mesh(scene).mesh;
  double area = 0;
  for (std::size_t p = 0; p < mesh.patch_count(); ++p) {
    EXPECT_GT(dot(mesh.normals[p], mesh.centroids[p] - Vec3d(6, 0.5, 0.5)), 0);  // still outwards
    area += mesh.areas[p];
  }
  EXPECT_DOUBLE_EQ(area, 10);  // 2 x 1 x 1
}

TEST(PatchMesh, TheDiffuseShareAndEmissionComeFromTheMaterial) {
  Scene scene = scene_of("lamp", {floor_rectangle(0, 1, 0, 1)});
  Material& material = scene.materials[0];
  material.base_colour = {0.5F, 0.25F, 1};
  material.metallic = 0.5F;
  material.transmission = 0.5F;
  material.emission = {1, 2, 4};
  const PatchMesh mesh = make_patch_mesh(scene, {.sides = PatchSides::both}).mesh;
  ASSERT_EQ(mesh.surface_count(), 2U);
  EXPECT_FALSE(mesh.surfaces[0].back);
  EXPECT_TRUE(mesh.surfaces[1].back);
  const double reflectance[] = {0.125, 0.0625, 0.25};
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_DOUBLE_EQ(mesh.reflectance[b], reflectance[b]);
    EXPECT_DOUBLE_EQ(mesh.reflectance[3 + b], reflectance[b]);
    EXPECT_DOUBLE_EQ(mesh.emission[b], std::numbers::pi * (1 << b));
    EXPECT_EQ(mesh.emission[3 + b], 0);
  }
  material.double_sided = true;
  EXPECT_DOUBLE_EQ(make_patch_mesh(scene, {.sides = PatchSides::both}).mesh.emission[3], std::numbers::pi);
}

TEST(PatchMesh, ATwoSidedPlateIsItsOwnBack) {
  const Polygon plate = floor_rectangle(0, 1, 0, 1);
  const Scene scene = scene_of("plate", {plate, reversed(plate), moved(plate, {0, 0, 1})});
  EXPECT_EQ(make_patch_mesh(scene).mesh.surface_count(), 3U);
  const PatchMesh mesh = make_patch_mesh(scene, {.sides = PatchSides::both}).mesh;
  ASSERT_EQ(mesh.surface_count(), 4U);  // only the third face has no twin
  EXPECT_TRUE(mesh.surfaces[3].back);
  EXPECT_NEAR(dot(mesh.normals[2], mesh.normals[3]), -1, 1e-15);
}

TEST(PatchMesh, GroupsByObjectAndMaterial) {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[0].base_colour = {0.2F, 0.2F, 0.2F};
  scene.materials[1].base_colour = {0.8F, 0.8F, 0.8F};
  scene.materials[1].name = "paint";
  add_polygons(scene, "a", room({1, 1, 1}), 0);
  add_polygons(scene, "b", reversed(room({0.1, 0.1, 0.1})), 1);
  scene.meshes[0].materials.assign(12, 0);
  scene.meshes[0].materials[2] = scene.meshes[0].materials[3] = 1;  // the ceiling
  const PatchMesh by_object = make_patch_mesh(scene, {.grouping = SurfaceGrouping::object}).mesh;
  ASSERT_EQ(by_object.surface_count(), 2U);
  EXPECT_EQ(by_object.surfaces[1].name, "b");
  EXPECT_EQ(by_object.surfaces[1].object, 1U);
  EXPECT_DOUBLE_EQ(by_object.surfaces[0].area, 6);
  EXPECT_NEAR(by_object.reflectance[0], (5 * 0.2 + 0.8) / 6, 1e-7);  // mean by area
  const PatchMesh by_material = make_patch_mesh(scene, {.grouping = SurfaceGrouping::material}).mesh;
  ASSERT_EQ(by_material.surface_count(), 2U);
  EXPECT_DOUBLE_EQ(by_material.surfaces[0].area, 5);
  EXPECT_EQ(by_material.surfaces[1].name, "paint");
  for (std::size_t p = 1; p < by_material.patch_count(); ++p) {
    EXPECT_GE(by_material.surface_of[p], by_material.surface_of[p - 1]);  // patches stand in the order of rows
  }
}

TEST(PatchMesh, NonPlanarFacesBecomeTrianglesWithOneWarning) {
  const Polygon bent{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}};
  const auto made = make_patch_mesh(scene_of("cloth", {bent, moved(bent, {2, 0, 0})}));
  EXPECT_EQ(made.mesh.patch_count(), 4U);
  EXPECT_EQ(made.mesh.surface_count(), 2U);
  ASSERT_EQ(made.warnings.size(), 1U);
  expect_contains(made.warnings[0], "2 polygons");
  expect_contains(made.warnings[0], "Face 1 of \"cloth\"");
  Polygon nearly = floor_rectangle(0, 1, 0, 1);
  nearly[2].z = 1e-7;  // below the tolerance
  EXPECT_EQ(make_patch_mesh(scene_of("floor", {nearly})).mesh.patch_count(), 1U);
}

TEST(PatchMesh, RefusesFacesWithoutMeaningAndNamesThem) {
  const Polygon good = floor_rectangle(0, 1, 0, 1);
  const Polygon bow_tie{{0, 0, 1}, {2, 2, 1}, {2, 0, 1}, {0, 1, 1}},
      figure_of_eight{{0, 0, 1}, {1, 1, 1}, {1, 0, 1}, {0, 1, 1}};
  const Polygon flat{{0, 0, 1}, {1, 0, 1}, {0.5, 0, 1}}, point{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  for (const Polygon& bad : {bow_tie, figure_of_eight}) {
    expect_contains(refusal(scene_of("thing", {good, bad})), "Face 2 of \"thing\" crosses itself");
  }
  for (const Polygon& bad : {flat, point}) {
    expect_contains(refusal(scene_of("thing", {good, bad})), "Face 2 of \"thing\" has no area");
    expect_contains(refusal(model_of({good, bad})), "Surface \"s2\" (line 11) has no area");
  }
  const Polygon same{good[2], good[3], good[0], good[1]};
  const std::string twice = refusal(scene_of("thing", {good, moved(good, {0, 0, 1}), same}));
  expect_contains(twice, "Face 3 of \"thing\"");
  expect_contains(twice, "Face 1 of \"thing\"");
  EXPECT_EQ(refusal(scene_of("thing", {good, reversed(good)})), "");
}

TEST(PatchMesh, DropsDegenerateFacesWhenAsked) {
  const Polygon good = floor_rectangle(0, 1, 0, 1), flat{{0, 0, 1}, {1, 0, 1}, {0.5, 0, 1}};
  const auto made = make_patch_mesh(scene_of("thing", {flat, good, flat}), {.degenerate = DegenerateFaces::drop});
  EXPECT_EQ(made.mesh.surface_count(), 1U);
  EXPECT_EQ(made.mesh.face_of[0], 1U);
  ASSERT_EQ(made.warnings.size(), 1U);
  expect_contains(made.warnings[0], "2 faces");
}

TEST(PatchMesh, RoundShapesBecomePolygonsOnlyWhenAsked) {
  Scene scene;
  scene.materials.emplace_back();
  scene.shapes.push_back({"ball", Sphere{}, 0});
  expect_contains(refusal(scene), "\"ball\"");
  EXPECT_EQ(make_patch_mesh(scene, {.shape_segments = 8}).mesh.patch_count(), 32U);
  scene.shapes.push_back({"ground", Plane{}, 0});
  expect_contains(refusal(scene, {.shape_segments = 8}), "\"ground\" is a plane without end");
}

TEST(PatchMesh, CombinedSurfacesShareARowAndObstructionsHaveNone) {
  PolygonModel model = model_of(room({1, 1, 1}));
  model.polygons[1].role = PolygonRole::obstructs;
  model.polygons[2].role = PolygonRole::masks;
  model.polygons[5].combines_with = 4;
  model.polygons[4].combines_with = 0;  // a chain: 6 into 5 into 1
  model.polygons[3].reflectance = 0.25;
  const PatchMesh mesh = make_patch_mesh(model).mesh;
  ASSERT_EQ(mesh.surface_count(), 2U);
  EXPECT_EQ(mesh.surfaces[0].name, "s1");
  EXPECT_EQ(mesh.surfaces[1].name, "s4");
  EXPECT_DOUBLE_EQ(mesh.surfaces[0].area, 3);
  EXPECT_EQ(mesh.bands, 1U);
  EXPECT_DOUBLE_EQ(mesh.reflectance[1], 0.25);
  EXPECT_EQ(mesh.patch_count(), 5U);
  EXPECT_EQ(mesh.radiating_count, 4U);
  EXPECT_EQ(mesh.surface_of[4], PatchMesh::no_surface);
  EXPECT_EQ(mesh.face_of[4], 1U);
}

TEST(PatchMesh, WindowsAreCutOutOfTheirWalls) {
  PolygonModel model =
      model_of({floor_rectangle(0, 4, 0, 3), floor_rectangle(1, 2, 1, 2), floor_rectangle(2.5, 3, 1, 2)});
  model.polygons[1].base = 0;
  model.polygons[2].base = 0;
  model.polygons[2].role = PolygonRole::masks;  // an opening
  const PatchMesh mesh = make_patch_mesh(model).mesh;
  ASSERT_EQ(mesh.surface_count(), 2U);
  EXPECT_NEAR(mesh.surfaces[0].area, 12 - 1 - 0.5, 1e-14);
  EXPECT_NEAR(mesh.surfaces[1].area, 1, 1e-14);
  // What the parts send to a ceiling is what the whole wall would.
  const Polygon ceiling = reversed(floor_rectangle(0, 4, 0, 3, 2)), opening = floor_rectangle(2.5, 3, 1, 2);
  double sum = exchange_area(opening, ceiling);
  for (std::size_t p = 0; p < mesh.patch_count(); ++p) sum += exchange_area(mesh.polygon(p), ceiling);
  EXPECT_NEAR(sum, exchange_area(floor_rectangle(0, 4, 0, 3), ceiling), 1e-12);
}

TEST(PatchMesh, RefusesModelsThatLeadNowhere) {
  const auto faces = room({1, 1, 1});
  PolygonModel circle = model_of(faces);
  circle.polygons[0].combines_with = 1;
  circle.polygons[1].combines_with = 0;
  expect_contains(refusal(circle), "Surface \"s1\" (line 10) is combined in a circle");
  PolygonModel beyond = model_of(faces);
  beyond.polygons[3].combines_with = 17;
  expect_contains(refusal(beyond), "Surface \"s4\" (line 13) is combined with surface 18, but there are 6");
  PolygonModel to_obstruction = model_of(faces);
  to_obstruction.polygons[3].combines_with = 0;
  to_obstruction.polygons[0].role = PolygonRole::obstructs;
  expect_contains(refusal(to_obstruction), "which does not radiate");
  PolygonModel no_vertex = model_of(faces);
  no_vertex.polygons[2].corners[1] = 99;
  expect_contains(refusal(no_vertex), "Surface \"s3\" (line 12) uses vertex 100, but there are 24");
  PolygonModel infinite = model_of(faces);
  infinite.vertices[0].x = std::numeric_limits<double>::infinity();
  expect_contains(refusal(infinite), "not a finite number");
  PolygonModel askew = model_of(faces);
  askew.polygons[2].base = 0;
  expect_contains(refusal(askew), "does not lie in the plane of its base");
}

}  // namespace
}  // namespace penumbra
