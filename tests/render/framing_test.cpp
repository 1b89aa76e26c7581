#include "penumbra/render/framing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;

/// Picture coordinates of a point, -1..1 from left to right and bottom to top, and its distance before the eye.
Vec3d in_picture(const Camera& camera, const Vec3d& p, double aspect) {
  const Vec3d v = transform_point(glm::inverse(camera.to_world), p);
  const double half = std::tan(std::get<PerspectiveLens>(camera.lens).vertical_fov / 2);
  return {v.x / (-v.z * half * aspect), v.y / (-v.z * half), -v.z};
}

TEST(Framing, ObjectsAreSeenWhole) {
  Dice dice(1);
  for (int n = 0; n < 40; ++n) {
    const Vec3d centre = dice.magnitude(-2, 3) * dice.direction();
    const double size = dice.magnitude(-2, 3);
    Mesh mesh = random_soup(30, size, 0.3 * size, 100 + static_cast<std::uint64_t>(n));
    for (Vec3d& p : mesh.positions) p = centre + Vec3d(1, dice.between(0.999, 1), 1) * p;
    const Scene scene = scene_of(mesh);
    const RayTracer tracer(scene);
    const double aspect = dice.between(0.4, 2.5);
    const Vec3d up = n % 2 == 0 ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1);
    const Camera camera = framing_camera(tracer, 0.7, aspect, up);
    double widest = 0;
    for (const Vec3d& p : mesh.positions) {
      const Vec3d at = in_picture(camera, p, aspect);
      ASSERT_GT(at.z, 0) << "behind the eye";
      widest = std::max({widest, std::abs(at.x), std::abs(at.y)});
    }
    EXPECT_LE(widest, 1);
    EXPECT_GT(widest, 0.8) << "small in the picture";
    EXPECT_GT(dot(Vec3d(camera.to_world[1]), up), 0) << "upright";
    EXPECT_GT(dot(Vec3d(camera.to_world[2]), up), 0) << "seen from above";
  }
}

TEST(Framing, ExactShapesAreSeenWhole) {
  Scene scene;
  add_shape(scene, Sphere{{3, 1, -2}, 2}, matt(Rgb(0.5F)));
  add_plane(scene, {0, -1, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  const RayTracer tracer(scene);
  const Camera camera = framing_camera(tracer, 0.7, 1.5, {0, 1, 0});
  Dice dice(2);
  for (int i = 0; i < 500; ++i) {
    const Vec3d at = in_picture(camera, Vec3d(3, 1, -2) + 2.0 * dice.direction(), 1.5);
    ASSERT_TRUE(at.z > 0 && std::abs(at.x) < 1 && std::abs(at.y) < 1);
  }
}

TEST(Framing, ClosedRoomsAreSeenFromInside) {
  Mesh room = box({-2, 0, -3}, {2, 2.5, 3});
  for (auto& [a, b, c] : room.triangles) std::swap(b, c);  // fronts inwards
  Scene scene = scene_of(room);
  add_mesh(scene, box({-0.5, 0, -1}, {0.3, 0.8, -0.4}), matt(Rgb(0.5F)));
  const RayTracer tracer(scene);
  const Camera camera = framing_camera(tracer, std::nullopt, 1.3, {0, 1, 0});
  const Vec3d eye(camera.to_world[3]);
  EXPECT_TRUE(std::abs(eye.x) < 2 && eye.y > 0 && eye.y < 2.5 && std::abs(eye.z) < 3);
  EXPECT_FALSE(std::abs(eye.x + 0.1) < 0.4 && eye.y < 0.8 && std::abs(eye.z + 0.7) < 0.3) << "inside the box";
  EXPECT_GT(camera.to_world[1].y, 0.7) << "upright";
}

TEST(Framing, AClosedBoxWithItsFrontsOutIsAnObject) {
  const Scene scene = scene_of(box({-1, -1, -1}, {1, 1, 1}));
  const RayTracer tracer(scene);
  const Vec3d eye(framing_camera(tracer, std::nullopt, 1, {0, 1, 0}).to_world[3]);
  EXPECT_GT(std::max({std::abs(eye.x), std::abs(eye.y), std::abs(eye.z)}), 1);
}

TEST(Framing, EvenAnEmptySceneGetsACamera) {
  const Scene scene;
  const RayTracer tracer(scene);
  const Camera camera = framing_camera(tracer, 0.7, 1, {0, 1, 0});
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) EXPECT_TRUE(std::isfinite(camera.to_world[i][k]));
  }
}

}  // namespace
}  // namespace penumbra
