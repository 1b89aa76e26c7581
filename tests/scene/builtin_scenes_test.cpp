#include "penumbra/scene/builtin_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

#include "penumbra/math/rng.h"
#include "penumbra/math/transform.h"

namespace penumbra {
namespace {

using Corners = std::array<Vec3d, 3>;

Corners corners(const Scene& scene, const Instance& instance, std::size_t triangle) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  Corners c{};
  for (std::size_t k = 0; k < 3; ++k) {
    c[k] = transform_point(instance.to_world, mesh.positions[mesh.triangles[triangle][k]]);
  }
  return c;
}

Vec3d area_vector(const Corners& c) { return 0.5 * cross(c[1] - c[0], c[2] - c[0]); }

/// Signed solid angle (van Oosterom & Strackee 1983), positive when the front faces the point.
double solid_angle(const Corners& c, const Vec3d& from) {
  const Vec3d a = normalize(c[0] - from), b = normalize(c[1] - from), d = normalize(c[2] - from);
  const double volume = dot(a, cross(b, d));
  return -2 * std::atan2(volume, 1 + dot(a, b) + dot(b, d) + dot(d, a));
}

/// 1 inside closed walls that face inwards, and in the air around closed solids within them.
double turns_around(const Scene& scene, const Vec3d& from) {
  double sum = 0;
  for (const Instance& instance : scene.instances) {
    for (std::size_t t = 0; t < scene.meshes[instance.mesh].triangles.size(); ++t) {
      sum += solid_angle(corners(scene, instance, t), from);
    }
  }
  return sum / (4 * std::numbers::pi);
}

std::size_t triangles(const Scene& scene) {
  std::size_t n = 0;
  for (const Instance& i : scene.instances) n += scene.meshes[i.mesh].triangles.size();
  return n;
}

const Mesh& mesh_called(const Scene& scene, std::string_view name) {
  const auto found = std::ranges::find(scene.meshes, name, &Mesh::name);
  if (found == scene.meshes.end()) throw std::runtime_error("no mesh " + std::string(name));
  return *found;
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const Mesh::Triangle& t : mesh.triangles) {
    sum += length(area_vector({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]}));
  }
  return sum;
}

/// Each directed edge once and its reverse once: closed and consistently wound.
::testing::AssertionResult is_closed(const Mesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> forth, back;
  for (const Mesh::Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      forth.emplace_back(t[k], t[(k + 1) % 3]);
      back.emplace_back(t[(k + 1) % 3], t[k]);
    }
  }
  std::ranges::sort(forth);
  std::ranges::sort(back);
  if (std::ranges::adjacent_find(forth) != forth.end()) return ::testing::AssertionFailure() << "an edge is used twice";
  if (forth != back) return ::testing::AssertionFailure() << "an edge has one side only";
  return ::testing::AssertionSuccess();
}

/// Signed volumes of a mesh's connected components: positive where fronts face outwards.
std::vector<double> volumes(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Mesh::Triangle& t : mesh.triangles) {
    parent[root(t[1])] = root(t[0]);
    parent[root(t[2])] = root(t[0]);
  }
  std::map<std::uint32_t, double> sums;
  for (const Mesh::Triangle& t : mesh.triangles) {
    const Vec3d origin = mesh.positions[root(t[0])];
    sums[root(t[0])] +=
        dot(mesh.positions[t[0]] - origin, cross(mesh.positions[t[1]] - origin, mesh.positions[t[2]] - origin)) / 6;
  }
  std::vector<double> values;
  for (const auto& [component, volume] : sums) values.push_back(volume);
  return values;
}

std::string refusal(std::string_view source) {
  try {
    (void)make_builtin_scene(source);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(BuiltinScenes, EveryListedSceneCanBeMadeAndHasACameraAndIndicesInRange) {
  ASSERT_GE(builtin_scenes().size(), 6U);
  for (const BuiltinScene& listed : builtin_scenes()) {
    SCOPED_TRACE(listed.name);
    const Scene scene = make_builtin_scene(listed.name);
    ASSERT_FALSE(scene.cameras.empty());
    EXPECT_EQ(scene.cameras[0].name, "camera");
    for (const Instance& instance : scene.instances) {
      ASSERT_LT(instance.mesh, scene.meshes.size());
      const Mesh& mesh = scene.meshes[instance.mesh];
      EXPECT_TRUE(mesh.materials.size() == 1 || mesh.materials.size() == mesh.triangles.size());
      for (const std::uint32_t m : mesh.materials) ASSERT_LT(m, scene.materials.size());
      for (const Mesh::Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : t) ASSERT_LT(v, mesh.positions.size());
        ASSERT_GT(length(area_vector({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]})), 0);
      }
      EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    }
    for (const ShapeObject& shape : scene.shapes) EXPECT_LT(shape.material, scene.materials.size());
  }
}

TEST(BuiltinScenes, UnknownNamesKeysAndValuesAreRefusedWithTheRemedy) {
  EXPECT_NE(refusal("cornel-box").find("did you mean 'cornell-box'"), std::string::npos);
  EXPECT_NE(refusal("cornel-box").find("atrium"), std::string::npos) << "the known ones are listed";
  EXPECT_EQ(refusal("zzzzzzzz").find("did you mean"), std::string::npos);
  EXPECT_NE(refusal("").find("cornell-box"), std::string::npos);
  EXPECT_NE(refusal("atrium?triangle=5000").find("triangles"), std::string::npos);
  EXPECT_NE(refusal("atrium?triangles=99").find("100 to 10000000"), std::string::npos);
  EXPECT_NE(refusal("atrium?triangles=10000001").find("100 to 10000000"), std::string::npos);
  EXPECT_NE(refusal("atrium?triangles=1000.5").find("whole number"), std::string::npos);
  EXPECT_NE(refusal("atrium?triangles=1000x").find("1000x"), std::string::npos);
  EXPECT_NE(refusal("atrium?triangles").find("100 to 10000000"), std::string::npos);
  EXPECT_NE(refusal("furnace?rho=nan").find("0 to 0.99"), std::string::npos);
  EXPECT_NE(refusal("furnace?rho=1").find("0 to 0.99"), std::string::npos);
  EXPECT_NE(refusal("cornell-box?x=1").find("no parameters"), std::string::npos);
  EXPECT_EQ(refusal("furnace?rho=0.25&emission=2"), "");
}

TEST(BuiltinScenes, TheCornellBoxHasTheMeasuredAreas) {
  const Scene scene = make_builtin_scene("cornell-box");
  ASSERT_EQ(scene.instances.size(), 16U);
  EXPECT_EQ(triangles(scene), 32U);
  EXPECT_NEAR(area(mesh_called(scene, "light")), 0.130 * 0.105, 1e-15);
  EXPECT_NEAR(area(mesh_called(scene, "floor")), (0.5528 + 0.5496) / 2 * 0.5592, 1e-15);
  EXPECT_NEAR(area(mesh_called(scene, "ceiling")), 0.556 * 0.5592, 1e-15);
  EXPECT_NEAR(area(mesh_called(scene, "right")), 0.5488 * 0.5592, 1e-15);
  EXPECT_EQ(mesh_called(scene, "left").face_count(), 2U) << "not planar: its diagonal is part of the scene";
  EXPECT_EQ(mesh_called(scene, "back").face_count(), 1U);
  EXPECT_EQ(mesh_called(scene, "back").face(0).size(), 4U);
}

TEST(BuiltinScenes, CornellFrontsFaceTheAirOfTheRoom) {
  const Scene scene = make_builtin_scene("cornell-box");
  const Vec3d middle(0.278, 0.45, 0.1);  // in the air, seen by every wall
  const Vec3d short_middle(0.186, 0.08, 0.169), tall_middle(0.369, 0.16, 0.351);
  for (const Instance& instance : scene.instances) {
    SCOPED_TRACE(instance.name);
    for (std::size_t t = 0; t < scene.meshes[instance.mesh].triangles.size(); ++t) {
      const Corners c = corners(scene, instance, t);
      if (instance.name.starts_with("short")) {
        EXPECT_LT(solid_angle(c, short_middle), 0);
      } else if (instance.name.starts_with("tall")) {
        EXPECT_LT(solid_angle(c, tall_middle), 0);
      } else {
        EXPECT_GT(solid_angle(c, middle), 0);
      }
    }
  }
  const Instance& lamp = *std::ranges::find(scene.instances, "light", &Instance::name);
  EXPECT_LT(area_vector(corners(scene, lamp, 0)).y, 0) << "it shines down";
  EXPECT_FALSE(scene.materials[scene.meshes[lamp.mesh].material_of(0)].double_sided);
}

TEST(BuiltinScenes, TheCornellCameraSeesXGrowToTheLeft) {
  const Scene scene = make_builtin_scene("cornell-box");
  const Ray left = scene.cameras[0].ray(0.25, 0.5, 1), centre = scene.cameras[0].ray(0.5, 0.5, 1);
  EXPECT_GT(left.direction.x, 0);
  EXPECT_NEAR(centre.direction.z, 1, 1e-15);
  // The lens of 35 mm over a frame of 25 mm.
  const Ray top = scene.cameras[0].ray(0.5, 0, 1);
  EXPECT_NEAR(top.direction.y / top.direction.z, 12.5 / 35, 1e-6);
}

TEST(BuiltinScenes, ThePlainScenesArePurelyLambertian) {
  for (const char* name : {"cornell-box", "furnace", "box345", "atrium"}) {
    for (const Material& m : make_builtin_scene(name).materials) {
      EXPECT_EQ(m.specular, 0) << name << " " << m.name;
      EXPECT_EQ(m.metallic, 0) << name << " " << m.name;
      EXPECT_EQ(m.transmission, 0) << name << " " << m.name;
      EXPECT_EQ(m.mirror, Rgb(0.0F)) << name << " " << m.name;
    }
  }
}

TEST(BuiltinScenes, TheSpheresRestOnTheCornellFloorWithinTheWalls) {
  const Scene scene = make_builtin_scene("cornell-spheres");
  ASSERT_EQ(scene.shapes.size(), 2U);
  std::vector<Sphere> spheres;
  for (const ShapeObject& object : scene.shapes) spheres.push_back(std::get<Sphere>(object.shape));
  for (const Sphere& s : spheres) {
    EXPECT_EQ(s.centre.y, s.radius);
    EXPECT_GT(s.centre.x, s.radius);
    EXPECT_LT(s.centre.x + s.radius, 0.5496);
    EXPECT_LT(s.centre.z + s.radius, 0.5592);
  }
  EXPECT_GT(length(spheres[0].centre - spheres[1].centre), spheres[0].radius + spheres[1].radius);
  EXPECT_EQ(scene.materials[scene.shapes[0].material].mirror, Rgb(0.95F));
  EXPECT_EQ(scene.materials[scene.shapes[1].material].transmission, 1);
}

TEST(BuiltinScenes, TheWhittedStillLifeStandsOnItsFloorAndTheGlassHangsLeft) {
  const Scene scene = make_builtin_scene("whitted");
  ASSERT_EQ(scene.shapes.size(), 45U);
  const Mat4d& eye = scene.cameras[0].to_world;
  const Vec3d right(eye[0]), position(eye[3]);
  double glass_side = 0;
  for (const ShapeObject& object : scene.shapes) {
    const auto* sphere = std::get_if<Sphere>(&object.shape);
    if (sphere == nullptr) continue;
    const Material& m = scene.materials[object.material];
    EXPECT_GE(sphere->centre.y + 1e-12, sphere->radius) << object.name;
    if (m.transmission > 0) glass_side = dot(right, sphere->centre - position);
  }
  EXPECT_LT(glass_side, 0);  // x = -0.6 where x grows to the picture's right
  EXPECT_TRUE(scene.environment && scene.environment->backdrop_only);
  // 50 degrees across 4 : 3.
  const Ray edge = scene.cameras[0].ray(1, 0.5, 4.0 / 3), centre = scene.cameras[0].ray(0.5, 0.5, 4.0 / 3);
  EXPECT_NEAR(std::acos(dot(edge.direction, centre.direction)), 25 * std::numbers::pi / 180, 1e-12);
}

TEST(BuiltinScenes, TheFurnaceIsClosedAndAlikeEverywhere) {
  const Scene scene = make_builtin_scene("furnace?rho=0.25&emission=3");
  ASSERT_EQ(scene.materials.size(), 1U);
  EXPECT_EQ(scene.materials[0].base_colour, Rgb(0.25F));
  EXPECT_EQ(scene.materials[0].emission, Rgb(3.0F));
  EXPECT_NEAR(area(mesh_called(scene, "room")), 24, 1e-12);
  const Vec3d eye(scene.cameras[0].to_world[3]);
  for (const Vec3d& p : {eye, Vec3d(0.9), Vec3d(-0.9, -0.9, 0.9)}) EXPECT_NEAR(turns_around(scene, p), 1, 1e-12);
  EXPECT_NEAR(turns_around(scene, Vec3d(2, 0, 0)), 0, 1e-12);
}

TEST(BuiltinScenes, TheBox345HasTheUnitSquaresOfItsFile) {
  for (int cubes = 0; cubes <= 2; ++cubes) {
    const Scene scene = make_builtin_scene("box345?cubes=" + std::to_string(cubes));
    std::size_t faces = 0;
    for (const Mesh& mesh : scene.meshes) {
      EXPECT_TRUE(is_closed(mesh)) << mesh.name;
      for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const auto face = mesh.face(f);
        ASSERT_EQ(face.size(), 4U);
        EXPECT_EQ(length(cross(mesh.positions[face[1]] - mesh.positions[face[0]],
                               mesh.positions[face[3]] - mesh.positions[face[0]])),
                  1.0);
      }
      faces += mesh.face_count();
    }
    EXPECT_EQ(faces, 94U + 6U * static_cast<std::size_t>(cubes));
    const Vec3d eye(scene.cameras[0].to_world[3]);
    EXPECT_NEAR(turns_around(scene, eye), 1, 1e-12);
    // In the middles of the cubes there is no air, once they are there.
    EXPECT_NEAR(turns_around(scene, {1.5, 1.5, -1.5}), cubes >= 1 ? 0 : 1, 1e-12);
    EXPECT_NEAR(turns_around(scene, {3.5, 1.5, -2.5}), cubes >= 2 ? 0 : 1, 1e-12);
  }
  // Some of the surfaces of the file (View3D's 3 x 4 x 5 box): s10, s40, s94, s106.
  const Scene scene = make_builtin_scene("box345");
  const auto corner = [&](const Mesh& mesh, std::size_t f, std::size_t k) { return mesh.positions[mesh.face(f)[k]]; };
  EXPECT_EQ(corner(scene.meshes[0], 9, 0), Vec3d(4, 1, 0));
  EXPECT_EQ(corner(scene.meshes[0], 39, 0), Vec3d(4, 4, 3));
  EXPECT_EQ(corner(scene.meshes[0], 93, 0), Vec3d(5, 3, 2));
  EXPECT_EQ(corner(scene.meshes[2], 5, 0), Vec3d(3, 2, 2));
  EXPECT_EQ(corner(scene.meshes[2], 5, 2), Vec3d(4, 3, 2));
}

TEST(BuiltinScenes, TheAtriumHasAsManyTrianglesAsAsked) {
  for (const std::size_t n :
       {100U, 101U, 150U, 333U, 1000U, 1999U, 3000U, 5000U, 7777U, 10000U, 20000U, 47000U, 100000U, 300001U}) {
    const std::size_t made = triangles(make_builtin_scene("atrium?triangles=" + std::to_string(n)));
    EXPECT_LE(made, n);
    EXPECT_GE(static_cast<double>(made), 0.98 * static_cast<double>(n));
  }
  EXPECT_GE(triangles(make_builtin_scene("atrium")), 9800U);
}

TEST(BuiltinScenes, TheAtriumIsMadeOfClosedSolidsInAClosedShell) {
  for (const char* name : {"atrium?triangles=100", "atrium?triangles=10000", "atrium?triangles=150000"}) {
    SCOPED_TRACE(name);
    for (const Mesh& mesh : make_builtin_scene(name).meshes) {
      SCOPED_TRACE(mesh.name);
      EXPECT_TRUE(is_closed(mesh));
      const std::vector<double> parts = volumes(mesh);
      if (mesh.name == "shell") {
        ASSERT_EQ(parts.size(), 1U);
        EXPECT_LT(parts[0], 0) << "fronts face inwards";
      } else {
        for (const double volume : parts) ASSERT_GT(volume, 0) << "fronts face outwards";
      }
    }
  }
}

TEST(BuiltinScenes, TheAtriumLetsNoRayOutFromItsAir) {
  const Scene scene = make_builtin_scene("atrium?triangles=20000");
  EXPECT_NEAR(turns_around(scene, Vec3d(scene.cameras[0].to_world[3])), 1, 1e-9);
  CounterRng random(7);
  for (int i = 0; i < 8; ++i) {  // over the court, above head height and below the light
    const Vec3d p(8 * random.next() - 4, 2.6 + 11 * random.next(), 18 * random.next() - 9);
    EXPECT_NEAR(turns_around(scene, p), 1, 1e-9) << p.x << " " << p.y << " " << p.z;
  }
}

TEST(BuiltinScenes, TheAtriumShinesDownFromTwoTriangles) {
  const Scene scene = make_builtin_scene("atrium?triangles=50000");
  std::size_t shining = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (!scene.materials[mesh.material_of(t)].emits()) continue;
      ++shining;
      EXPECT_LT(area_vector(corners(scene, instance, t)).y, 0);
    }
  }
  EXPECT_EQ(shining, 2U);
}

TEST(BuiltinScenes, TheSameAtriumTwice) {
  const Scene a = make_builtin_scene("atrium?triangles=60000"), b = make_builtin_scene("atrium?triangles=60000");
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t m = 0; m < a.meshes.size(); ++m) {
    EXPECT_EQ(a.meshes[m].positions, b.meshes[m].positions);
    EXPECT_EQ(a.meshes[m].triangles, b.meshes[m].triangles);
  }
}

}  // namespace
}  // namespace penumbra
