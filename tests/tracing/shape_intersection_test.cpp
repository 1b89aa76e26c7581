#include "penumbra/tracing/shape_intersection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "penumbra/tracing/ray_tracer.h"
#include "tracing/soup.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using testing::Dice;

/// A ray that arrives at `point` after `distance`, from the side of `normal`.
Ray ray_to(Dice& dice, const Vec3d& point, const Vec3d& normal, double distance) {
  Vec3d direction;
  do {
    direction = dice.direction();
  } while (dot(direction, normal) > -0.1);
  return {.origin = point - distance * direction, .direction = direction};
}

TEST(ShapeIntersection, SpheresFromOutsideAndInside) {
  Dice dice(1);
  for (int n = 0; n < 2000; ++n) {
    const Sphere sphere{dice.cube(3), dice.between(0.1, 2)};
    const Vec3d normal = dice.direction();
    const double distance = dice.between(0.01, 5);
    const Ray ray = ray_to(dice, sphere.centre + sphere.radius * normal, normal, distance);
    ASSERT_NEAR(intersect(sphere, ray).value(), distance, 1e-12 * 50);
    // Beyond the near wall, the far one: a chord of length 2 r cos.
    Ray inside = ray;
    inside.t_min = distance + 1e-6;
    const double chord = -2 * sphere.radius * dot(ray.direction, normal);
    ASSERT_NEAR(intersect(sphere, inside).value(), distance + chord, 1e-12 * 50);
    inside.t_min = distance + chord + 1e-6;
    ASSERT_FALSE(intersect(sphere, inside));
    Ray early = ray;
    early.t_max = distance - 1e-6;
    ASSERT_FALSE(intersect(sphere, early));
  }
}

TEST(ShapeIntersection, SpheresKeepTheirDigitsFarAway) {
  const Sphere sphere{Vec3d(0), 1};
  for (const double distance : {10.0, 1e3, 1e6}) {
    for (const double off : {0.0, 0.5, 0.999999}) {
      const Ray ray{.origin = {off, 0, distance}, .direction = {0, 0, -1}};
      EXPECT_NEAR(intersect(sphere, ray).value(), distance - std::sqrt(1 - off * off), 1e-13 * distance + 1e-12);
    }
    EXPECT_FALSE(intersect(sphere, {.origin = {1 + 1e-9, 0, distance}, .direction = {0, 0, -1}}));
    EXPECT_TRUE(intersect(sphere, {.origin = {1 - 1e-9, 0, distance}, .direction = {0, 0, -1}}));
  }
}

TEST(ShapeIntersection, PlanesAndDisks) {
  Dice dice(2);
  for (int n = 0; n < 2000; ++n) {
    const Disk disk{dice.cube(3), dice.direction(), dice.between(0.1, 2)};
    const Frame frame(disk.normal);
    const double from_centre = disk.radius * dice.between(0, 2);
    const double phi = dice.between(0, 2 * pi);
    const Vec3d point = disk.centre + from_centre * (std::cos(phi) * frame.tangent + std::sin(phi) * frame.bitangent);
    const double distance = dice.between(0.01, 5);
    const Vec3d side = dice.unit() < 0.5 ? disk.normal : -disk.normal;
    const Ray ray = ray_to(dice, point, side, distance);
    ASSERT_NEAR(intersect(Plane{disk.centre, disk.normal}, ray).value(), distance, 1e-12 * 100);
    if (std::abs(from_centre - disk.radius) < 1e-9) continue;
    const auto t = intersect(disk, ray);
    ASSERT_EQ(t.has_value(), from_centre < disk.radius);
    if (t) {
      ASSERT_NEAR(*t, distance, 1e-12 * 100);
    }
  }
  EXPECT_FALSE(intersect(Plane{}, {.origin = {0, 1, 0}, .direction = {1, 0, 0}})) << "parallel";
  EXPECT_FALSE(intersect(Plane{}, {.origin = {0, 1, 0}, .direction = {0, 1, 0}})) << "behind";
}

TEST(ShapeIntersection, CylindersAreOpenAtBothEnds) {
  Dice dice(3);
  for (int n = 0; n < 2000; ++n) {
    const Vec3d base = dice.cube(3);
    const Vec3d axis = dice.direction();
    const double height = dice.between(0.2, 3);
    const Cylinder cylinder{base, base + height * axis, dice.between(0.1, 2)};
    const Frame frame(axis);
    const double phi = dice.between(0, 2 * pi);
    const Vec3d normal = std::cos(phi) * frame.tangent + std::sin(phi) * frame.bitangent;
    const double along = height * dice.between(0.01, 0.99);
    const Vec3d point = base + along * axis + cylinder.radius * normal;
    const double distance = dice.between(0.01, 5);
    const Ray ray = ray_to(dice, point, normal, distance);
    ASSERT_NEAR(intersect(cylinder, ray).value(), distance, 1e-12 * 1000);
    // Through the wall to the other side of the inside, or out at an end.
    Ray inside = ray;
    inside.t_min = distance + 1e-6;
    const Vec3d across = ray.direction - dot(ray.direction, axis) * axis;
    const double chord = -2 * cylinder.radius * dot(across, normal) / dot(across, across);
    const double end = along + chord * dot(ray.direction, axis);
    if (std::abs(end) < 1e-6 || std::abs(end - height) < 1e-6) continue;
    const auto far = intersect(cylinder, inside);
    ASSERT_EQ(far.has_value(), end > 0 && end < height);
    if (far) {
      ASSERT_NEAR(*far, distance + chord, 1e-9);
    }
    ASSERT_FALSE(intersect(cylinder, {.origin = base - axis, .direction = axis})) << "along the axis";
  }
}

TEST(ShapePoint, NormalsPointOutAndTangentsFollowU) {
  Dice dice(4);
  const std::vector<Shape> shapes = {Sphere{{1, 2, 3}, 0.7}, Disk{{1, 0, -1}, dice.direction(), 1.5},
                                     Cylinder{{0, 1, 0}, {1, 3, 0.5}, 0.4}, Plane{{0, 0.5, 0}, dice.direction()}};
  const Vec3d insides[] = {{1, 2, 3}, {0, 0, 0}, {0.5, 2, 0.25}, {0, 0, 0}};
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (int n = 0; n < 200; ++n) {
      const ShapePoint p = shape_point(shapes[i], insides[i] + dice.cube(0.2));
      ASSERT_NEAR(length(p.normal), 1, 1e-12);
      ASSERT_NEAR(length(p.tangent), 1, 1e-12);
      ASSERT_NEAR(dot(p.tangent, p.normal), 0, 1e-9);
      const ShapePoint q = shape_point(shapes[i], p.position);
      EXPECT_LT(length(normalize(shape_normal(shapes[i], p.position)) - p.normal), 1e-12);
      ASSERT_LT(length(q.position - p.position), 1e-12) << "it stays where it is";
      constexpr double step = 1e-3;
      float du = shape_point(shapes[i], p.position + step * p.tangent).uv.x - p.uv.x;
      if (std::abs(du) > 0.5F && i != 3) continue;  // across the seam
      ASSERT_GT(du, 0) << "shape " << i;
      const Vec3d bitangent = cross(p.normal, p.tangent);
      du = shape_point(shapes[i], p.position + step * bitangent).uv.x - p.uv.x;
      ASSERT_LT(std::abs(du), 1e-4F) << "shape " << i;
    }
  }
}

TEST(ShapeBounds, HoldEveryPointAndAreTight) {
  Dice dice(5);
  const Vec3d axis = dice.direction();
  const std::vector<Shape> shapes = {Sphere{{1, 2, 3}, 0.7}, Disk{{1, 0, -1}, axis, 1.5},
                                     Cylinder{{0, 1, 0}, {1, 3, 0.5}, 0.4}, Plane{{0, 0.5, 0}, axis}};
  for (const Shape& shape : shapes) {
    const Bounds b = shape_bounds(shape, 2);
    Bounds seen;
    Dice points(6);
    for (int n = 0; n < 20000; ++n) {
      const double phi = points.between(0, 2 * pi);
      Vec3d p(0);
      const auto on_circle = [&](const Vec3d& centre, const Vec3d& normal, double r) {
        const Frame f(normal);
        return centre + r * (std::cos(phi) * f.tangent + std::sin(phi) * f.bitangent);
      };
      if (const auto* s = std::get_if<Sphere>(&shape)) p = s->centre + s->radius * points.direction();
      if (const auto* d = std::get_if<Disk>(&shape)) p = on_circle(d->centre, d->normal, d->radius);
      if (const auto* c = std::get_if<Cylinder>(&shape)) {
        p = on_circle(n % 2 == 0 ? c->base : c->top, normalize(c->top - c->base), c->radius);
      }
      if (const auto* q = std::get_if<Plane>(&shape)) p = on_circle(q->point, q->normal, 2);
      seen.grow(p);
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(seen.lower[k], b.lower[k] - 1e-12);
      EXPECT_LE(seen.upper[k], b.upper[k] + 1e-12);
      EXPECT_NEAR(seen.lower[k], b.lower[k], 0.01);
      EXPECT_NEAR(seen.upper[k], b.upper[k], 0.01);
    }
  }
}

TEST(RayTracerShapes, AreMetWhereTheFunctionsSay) {
  Scene scene;
  scene.materials.emplace_back();
  Dice dice(7);
  for (int i = 0; i < 8; ++i) {
    scene.shapes.push_back({"", Sphere{dice.cube(2), dice.between(0.1, 0.6)}, 0});
    scene.shapes.push_back({"", Disk{dice.cube(2), dice.direction(), dice.between(0.2, 1)}, 0});
    const Vec3d base = dice.cube(2);
    scene.shapes.push_back({"", Cylinder{base, base + dice.direction(), dice.between(0.1, 0.5)}, 0});
  }
  scene.shapes.push_back({"", Plane{{0, -3, 0}, normalize(Vec3d(0.1, 1, 0))}, 0});
  const RayTracer tracer(scene);
  int hits = 0, differing = 0;
  for (int n = 0; n < 10000; ++n) {
    const Vec3d origin = testing::as_float(dice.cube(4));
    const Ray ray{.origin = origin, .direction = testing::as_float(dice.direction())};
    double nearest = 1e30;
    std::size_t object = 0;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
      const auto t = std::visit([&](const auto& s) { return intersect(s, ray); }, scene.shapes[i].shape);
      if (t && *t < nearest) nearest = *t, object = i;
    }
    const auto hit = tracer.nearest(ray);
    if (nearest > 1e4 && nearest < 1e30) continue;  // near the horizon, where the tracer's plane ends
    ASSERT_EQ(hit.has_value(), nearest <= 1e4) << nearest;
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(hit->t, nearest, 1e-6 * nearest);
    differing += hit->object != object ? 1 : 0;
    const SurfacePoint p = tracer.surface_point(ray, *hit);
    ASSERT_LT(length(p.position - ray.at(nearest)), 1e-5 * (1 + nearest));
    ASSERT_LT(length(p.geometric_normal - shape_point(scene.shapes[object].shape, p.position).normal), 1e-5);
    ASSERT_TRUE(tracer.occluded(ray));
  }
  EXPECT_GT(hits, 5000);
  EXPECT_EQ(differing, 0);
}

}  // namespace
}  // namespace penumbra
