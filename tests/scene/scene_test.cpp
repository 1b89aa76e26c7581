#include "penumbra/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "penumbra/math/transform.h"

namespace penumbra {
namespace {

Scene one_triangle() {
  Scene scene;
  scene.materials.emplace_back();
  Mesh mesh;
  mesh.name = "wedge";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"wedge", 0, Mat4d(1.0)});
  return scene;
}

void expect_near(const Vec3d& a, const Vec3d& b) { EXPECT_LT(length(a - b), 1e-12) << a.x << " " << a.y << " " << a.z; }

TEST(SceneTest, CountsTrianglesOfEachInstance) {
  Scene scene = one_triangle();
  EXPECT_EQ(scene.triangle_count(), 1U);
  scene.instances.resize(3, scene.instances[0]);
  EXPECT_EQ(scene.triangle_count(), 3U);
  EXPECT_EQ(Scene{}.triangle_count(), 0U);
}

TEST(SceneTest, BoundsFollowTheInstances) {
  Scene scene = one_triangle();
  Mat4d quarter_turn(1.0);  // x to y, y to -x, then 10 along z
  quarter_turn[0] = {0, 1, 0, 0};
  quarter_turn[1] = {-1, 0, 0, 0};
  quarter_turn[3] = {0, 0, 10, 1};
  scene.instances[0].to_world = quarter_turn;
  expect_near(scene.bounds().lower, {-2, 0, 10});
  expect_near(scene.bounds().upper, {0, 1, 10});
}

TEST(SceneTest, BoundsOfExactShapes) {
  Scene scene;
  scene.materials.emplace_back();
  scene.shapes.push_back({"ball", Sphere{{1, 2, 3}, 0.5}, 0});
  expect_near(scene.bounds().lower, {0.5, 1.5, 2.5});
  scene.shapes = {{"coin", Disk{{0, 5, 0}, {0, 1, 0}, 2}, 0}};
  expect_near(scene.bounds().lower, {-2, 5, -2});
  expect_near(scene.bounds().upper, {2, 5, 2});
  scene.shapes = {{"pipe", Cylinder{{0, 0, 0}, {0, 0, 4}, 1}, 0}};
  expect_near(scene.bounds().lower, {-1, -1, 0});
  expect_near(scene.bounds().upper, {1, 1, 4});
  const double s = std::sqrt(0.5);  // a disk at 45 degrees reaches r / sqrt 2 along both axes that it leans in
  scene.shapes = {{"coin", Disk{{0, 0, 0}, {s, s, 0}, 1}, 0}};
  expect_near(scene.bounds().upper, {s, s, 1});
  scene.shapes = {{"floor", Plane{}, 0}};
  EXPECT_TRUE(scene.bounds().empty());
}

TEST(ValidateTest, AcceptsAWholeScene) {
  EXPECT_NO_THROW(validate(Scene{}));
  EXPECT_NO_THROW(validate(one_triangle()));
}

TEST(ValidateTest, NamesWhatIsWrong) {
  struct Fault {
    std::string named;
    std::function<void(Scene&)> make;
  };
  const std::vector<Fault> faults{
      {"mesh 0 'wedge'", [](Scene& s) { s.meshes[0].positions[1].y = NAN; }},
      {"mesh 0 'wedge'", [](Scene& s) { s.meshes[0].triangles[0][2] = 3; }},
      {"mesh 0 'wedge'", [](Scene& s) { s.meshes[0].materials = {1}; }},
      {"mesh 0 'wedge'",
       [](Scene& s) {
         s.meshes[0].materials = {0, 0};
       }},
      {"mesh 0 'wedge'",
       [](Scene& s) {
         s.meshes[0].normals = {{0, 1, 0}};
       }},
      {"mesh 0 'wedge'",
       [](Scene& s) {
         s.meshes[0].uv[1] = {{0, 0}, {0, INFINITY}, {0, 0}};
       }},
      {"mesh 0 'wedge'",
       [](Scene& s) {
         s.meshes[0].face_vertices = {0, 1, 2};
       }},
      {"mesh 0 'wedge'",
       [](Scene& s) {
         s.meshes[0].face_offsets = {0, 3};
         s.meshes[0].face_vertices = {0, 1, 3};
         s.meshes[0].face_of_triangle = {0};
       }},
      {"mesh 0 'wedge'",
       [](Scene& s) {
         s.meshes[0].face_offsets = {0, 3};
         s.meshes[0].face_vertices = {0, 1, 2};
         s.meshes[0].face_of_triangle = {1};
       }},
      {"object 0 'wedge'", [](Scene& s) { s.instances[0].mesh = 1; }},
      {"object 0 'wedge'", [](Scene& s) { s.instances[0].to_world[3][0] = INFINITY; }},
      {"object 1 'ball'",
       [](Scene& s) {
         s.shapes.push_back({"ball", Sphere{{0, 0, 0}, -1}, 0});
       }},
      {"object 1 'coin'",
       [](Scene& s) {
         s.shapes.push_back({"coin", Disk{{0, 0, 0}, {0, 2, 0}, 1}, 0});
       }},
      {"object 1 'ball'",
       [](Scene& s) {
         s.shapes.push_back({"ball", Sphere{}, 7});
       }},
      {"material 0 'clay'",
       [](Scene& s) {
         s.materials[0].name = "clay";
         s.materials[0].base_colour.y = NAN;
       }},
      {"material 0", [](Scene& s) { s.materials[0].emission_texture = TextureRef{}; }},
      {"texture 0", [](Scene& s) { s.textures.push_back({.image = 2}); }},
      {"image 0 'dots'",
       [](Scene& s) {
         s.images.push_back(
             {.name = "dots", .width = 2, .height = 2, .channels = 3, .texels = std::vector<std::uint8_t>(3)});
       }},
      {"light 0 'lamp'",
       [](Scene& s) {
         s.lights.push_back({"lamp", PointLight{{NAN, 0, 0}, Rgb(1.0F)}});
       }},
      {"camera 0 'eye'",
       [](Scene& s) {
         s.cameras.push_back({"eye", Mat4d(1.0), PerspectiveLens{4.0}});
       }},
      {"environment",
       [](Scene& s) {
         s.environment = Environment{Rgb(1.0F), 0U};
       }},
  };
  for (std::size_t i = 0; i < faults.size(); ++i) {
    Scene scene = one_triangle();
    faults[i].make(scene);
    try {
      validate(scene);
      ADD_FAILURE() << "fault " << i << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).find(faults[i].named), 0U) << "fault " << i << ": " << error.what();
    }
  }
}

}  // namespace
}  // namespace penumbra
