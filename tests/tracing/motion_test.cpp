// Objects that move while the shutter is open, as rays of different times meet them.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "penumbra/tracing/ray_tracer.h"
#include "tracing/soup.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

Mat4d turned(double angle) { return glm::rotate(Mat4d(1.0), angle, Vec3d(0, 0, 1)); }

TEST(Motion, AnEvenWayNeedsTwoSteps) {
  const Motion motion = sampled_motion([](double t) { return glm::translate(Mat4d(1.0), Vec3d(3 * t, -t, 0)); });
  ASSERT_EQ(motion.size(), 2U);
  EXPECT_LT(length(Vec3d(placement_at(motion, 0.3)[3]) - Vec3d(0.9, -0.3, 0)), 1e-12);
  EXPECT_TRUE(sampled_motion([](double) { return Mat4d(2.0); }).empty());
}

// A way there and back is at its start again half way and at the end.
TEST(Motion, ReturningIsSeenToo) {
  const Motion motion =
      sampled_motion([](double t) { return glm::translate(Mat4d(1.0), Vec3d(std::sin(2 * pi * t), 0, 0)); }, 1e-3);
  ASSERT_GT(motion.size(), 8U);
  for (double t = 0; t <= 1; t += 0.01) {
    EXPECT_NEAR(placement_at(motion, t)[3].x, std::sin(2 * pi * t), 2e-3);
  }
}

TEST(Motion, TurningKeepsItsSize) {
  const Motion motion = sampled_motion([](double t) { return turned(pi / 2 * t); });
  for (double t = 0; t <= 1; t += 0.003) {
    const Mat4d m = placement_at(motion, t);
    EXPECT_NEAR(length(Vec3d(m[0])), 1, 2e-5);
    EXPECT_NEAR(std::atan2(m[0].y, m[0].x), pi / 2 * t, 1e-5);
  }
}

/// A scene of one mesh that turns, shifts and stretches.
Scene moving_soup(Motion& motion) {
  Dice dice(5);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const Vec3d middle = dice.cube(1);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(as_float(middle + dice.cube(0.5)));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  Scene scene = scene_of(mesh);
  motion = sampled_motion(
      [](double t) {
        return glm::translate(Mat4d(1.0), Vec3d(t, 0, 0)) * turned(1.5 * t) *
               glm::scale(Mat4d(1.0), Vec3d(1 + t, 1, 1));
      },
      1e-5);
  scene.instances[0].motion = motion;
  return scene;
}

TEST(Motion, IsAtEachTimeASceneAtRestThere) {
  Motion motion;
  const Scene scene = moving_soup(motion);
  const RayTracer tracer(scene);
  EXPECT_TRUE(tracer.has_motion());
  Dice dice(6);
  int hits = 0;
  for (int k = 0; k < 20; ++k) {
    const double time = static_cast<double>(static_cast<float>(dice.unit()));
    Scene still = scene;
    still.instances[0].motion.clear();
    still.instances[0].to_world = placement_at(motion, time);
    const RayTracer at_rest(still);
    EXPECT_FALSE(at_rest.has_motion());
    for (int i = 0; i < 200; ++i) {
      Ray ray{.origin = 4.0 * dice.direction(), .direction = {}, .time = time};
      ray.direction = normalize(dice.cube(1) - ray.origin);
      const auto moving = tracer.nearest(ray);
      const auto resting = at_rest.nearest(ray);
      if (moving.has_value() != resting.has_value() || (moving && moving->primitive != resting->primitive)) {
        continue;  // at an edge
      }
      EXPECT_EQ(tracer.occluded(ray), moving.has_value());
      if (!moving) continue;
      ++hits;
      EXPECT_NEAR(moving->t, resting->t, 1e-4);
      const SurfacePoint a = tracer.surface_point(ray, *moving);
      const SurfacePoint b = at_rest.surface_point(ray, *resting);
      EXPECT_LT(length(a.position - b.position), 1e-4);
      EXPECT_LT(length(a.position - ray.at(moving->t)), 1e-4);
      EXPECT_LT(length(a.geometric_normal - b.geometric_normal), 1e-6);
      EXPECT_EQ(a.time, time);
      EXPECT_EQ(leave(a, ray.direction).time, time);
      EXPECT_EQ(segment(a, Vec3d(9, 9, 9)).time, time);
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(Motion, PacketsHaveATimeALane) {
  Motion motion;
  const Scene scene = moving_soup(motion);
  const RayTracer tracer(scene);
  Dice dice(8);
  int hits = 0;
  for (int k = 0; k < 60; ++k) {
    RayPacket packet;
    Ray rays[RayPacket::size];
    for (int i = 0; i < RayPacket::size; ++i) {
      Ray& ray = rays[i];
      ray.origin = as_float(4.0 * dice.direction());
      ray.direction = as_float(normalize(dice.cube(1) - ray.origin));
      ray.time = static_cast<double>(static_cast<float>(dice.unit()));
      packet.origin_x[i] = static_cast<float>(ray.origin.x);
      packet.origin_y[i] = static_cast<float>(ray.origin.y);
      packet.origin_z[i] = static_cast<float>(ray.origin.z);
      packet.direction_x[i] = static_cast<float>(ray.direction.x);
      packet.direction_y[i] = static_cast<float>(ray.direction.y);
      packet.direction_z[i] = static_cast<float>(ray.direction.z);
      packet.t_min[i] = 0;
      packet.t_max[i] = std::numeric_limits<float>::infinity();
      packet.time[i] = static_cast<float>(ray.time);
      packet.active[i] = -1;
    }
    HitPacket found;
    tracer.nearest(packet, found);
    for (int i = 0; i < RayPacket::size; ++i) {
      const auto one = tracer.nearest(rays[i]);
      if (one.has_value() != (found.object[i] != HitPacket::no_hit)) continue;
      if (!one || one->primitive != found.primitive[i]) continue;
      ++hits;
      EXPECT_NEAR(one->t, found.t[i], 1e-4);
      const Vec3d normal = normalize(Vec3d(found.normal_x[i], found.normal_y[i], found.normal_z[i]));
      EXPECT_LT(length(normal - tracer.surface_point(rays[i], *one).geometric_normal), 1e-3);
    }
  }
  EXPECT_GT(hits, 200);
}

TEST(Motion, BoundsHoldTheWholeWay) {
  Mesh mesh = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  Scene scene = scene_of(mesh);
  scene.instances[0].motion = {Mat4d(1.0), glm::translate(Mat4d(1.0), Vec3d(5, 0, 0))};
  const RayTracer tracer(scene);
  EXPECT_EQ(tracer.bounds().lower.x, 0);
  EXPECT_EQ(tracer.bounds().upper.x, 6);
}

}  // namespace
}  // namespace penumbra
