#include "penumbra/tracing/shape_list.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shape_intersection.h"
#include "tracing/soup.h"

namespace penumbra {
namespace {

using testing::as_float;
using testing::Dice;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Spheres of many sizes and places, the world's origin up to `shift` away, and a shape of every other kind.
std::vector<Shape> random_shapes(Dice& dice, int spheres, double shift) {
  const Vec3d middle = dice.cube(shift);
  std::vector<Shape> shapes{Plane{middle - Vec3d(0, 3, 0), {0, 1, 0}},
                            Disk{middle + dice.cube(2), dice.direction(), 1.5},
                            Cylinder{middle + dice.cube(2), middle + dice.cube(2), 0.3}};
  for (int i = 0; i < spheres; ++i) {
    shapes.push_back(Sphere{middle + dice.cube(4), std::pow(10.0, dice.between(-3, 0.3))});
  }
  return shapes;
}

struct Brute {
  double t = infinite;
  std::size_t shape = 0;
};

Brute brute_force(const std::vector<Shape>& shapes, const Ray& ray) {
  Brute best{.t = ray.t_max};
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto t = std::visit([&](const auto& s) { return intersect(s, ray); }, shapes[i]);
    if (t && *t < best.t) best = {*t, i};
  }
  return best;
}

/// Rays from around and within the shapes; a third aim at a sphere's rim, where the sieve is near its limit.
Ray random_ray(Dice& dice, const std::vector<Shape>& shapes) {
  const auto& sphere = std::get<Sphere>(shapes[3 + dice.below(shapes.size() - 3)]);
  const Vec3d origin = as_float(sphere.centre + dice.cube(6));
  Vec3d aim = sphere.centre + dice.cube(1.2 * sphere.radius);
  if (dice.below(3) == 0) {
    const Vec3d way = normalize(sphere.centre - origin);
    aim = sphere.centre + sphere.radius * normalize(cross(way, dice.direction()));
  }
  const double t_max = dice.below(4) == 0 ? static_cast<float>(dice.between(1, 12)) : infinite;
  return {.origin = origin, .direction = as_float(normalize(aim - origin)), .t_min = 0, .t_max = t_max};
}

TEST(ShapeList, MeetsWhatEachShapeAloneWouldToTheSameBits) {
  Dice dice(5);
  for (const auto& [spheres, shift] : {std::pair{1, 0.0}, {17, 10.0}, {46, 1000.0}}) {
    const std::vector<Shape> shapes = random_shapes(dice, spheres, shift);
    ShapeList list;
    for (std::size_t i = 0; i < shapes.size(); ++i) list.add(shapes[i], static_cast<std::uint32_t>(100 + i));
    int met = 0;
    for (int round = 0; round < 400; ++round) {
      RayPacket packet{};
      HitPacket hits;
      std::vector<Ray> rays;
      for (int i = 0; i < RayPacket::size; ++i) {
        const Ray& ray = rays.emplace_back(random_ray(dice, shapes));
        packet.origin_x[i] = static_cast<float>(ray.origin.x);
        packet.origin_y[i] = static_cast<float>(ray.origin.y);
        packet.origin_z[i] = static_cast<float>(ray.origin.z);
        packet.direction_x[i] = static_cast<float>(ray.direction.x);
        packet.direction_y[i] = static_cast<float>(ray.direction.y);
        packet.direction_z[i] = static_cast<float>(ray.direction.z);
        packet.t_max[i] = static_cast<float>(ray.t_max);
        packet.active[i] = dice.below(8) == 0 ? 0 : -1;
      }
      list.nearest(packet, hits);
      RayPacket shadows = packet;
      list.occluded(shadows);
      for (int i = 0; i < RayPacket::size; ++i) {
        const Ray& ray = rays[static_cast<std::size_t>(i)];
        const Brute truth = brute_force(shapes, ray);
        const bool hit = truth.t < ray.t_max;
        const auto single = list.nearest(ray);
        ASSERT_EQ(single.has_value(), hit);
        ASSERT_EQ(list.occluded(ray), hit);
        if (hit) {
          ASSERT_EQ(single->t, truth.t);
          ASSERT_EQ(single->object, 100 + truth.shape);
        }
        if (packet.active[i] == 0) {
          ASSERT_EQ(hits.object[i], HitPacket::no_hit);
          continue;
        }
        ASSERT_EQ(shadows.active[i] == 0, hit);
        ASSERT_EQ(hits.object[i], hit ? 100 + truth.shape : HitPacket::no_hit);
        if (!hit) continue;
        ++met;
        ASSERT_EQ(hits.t[i], static_cast<float>(truth.t));
        const Vec3d n(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
        const Vec3d expected = shape_point(shapes[truth.shape], ray.at(truth.t)).normal;
        ASSERT_NEAR(dot(normalize(n), expected), 1, 1e-6);
      }
    }
    EXPECT_GT(met, 2000);
  }
}

// Many spheres stand in the hierarchy, few in the list: what is met does not depend on it.
TEST(ShapeList, AHierarchyFindsTheSameSpheres) {
  Dice dice(6);
  Scene few, many;
  few.materials.resize(1);
  many.materials.resize(1);
  for (std::size_t i = 0; i < ShapeList::longest + 1; ++i) {
    const ShapeObject object{"ball", Sphere{dice.cube(4), dice.between(0.05, 0.5)}, 0};
    if (i < ShapeList::longest) few.shapes.push_back(object);
    many.shapes.push_back(object);
  }
  std::get<Sphere>(many.shapes.back().shape).centre = {0, 1000, 0};  // out of the way
  const RayTracer listed(few), built(many);
  int met = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3d origin = as_float(dice.cube(6));
    Ray ray{.origin = origin, .direction = as_float(normalize(dice.cube(4) - origin))};
    const auto a = listed.nearest(ray);
    const auto b = built.nearest(ray);
    ASSERT_EQ(a.has_value(), b.has_value());
    ASSERT_EQ(listed.occluded(ray), built.occluded(ray));
    if (!a) continue;
    ++met;
    ASSERT_EQ(a->object, b->object);
    ASSERT_NEAR(a->t, b->t, 1e-6 * b->t);  // the hierarchy keeps distances in single precision
  }
  EXPECT_GT(met, 500);
}

// An infinite plane has no end, however small the rest of the scene is.
TEST(ShapeList, PlanesReachToTheHorizon) {
  Scene scene;
  scene.materials.resize(1);
  scene.shapes = {{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, 0}, {"ball", Sphere{{0, 1, 0}, 1}, 0}};
  const RayTracer tracer(scene);
  const Ray ray{.origin = {0, 1, 5}, .direction = normalize(Vec3d(0, -1e-7, 1))};
  const auto hit = tracer.nearest(ray);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 1e7, 1e2);
}

}  // namespace
}  // namespace penumbra
