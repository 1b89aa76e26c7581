#include "penumbra/tracing/ray_differential.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tracing/soup.h"

namespace penumbra {
namespace {

constexpr double h = 2e-3;  // hits come in single precision

/// What becomes of a ray at the first surface that it meets.
struct Turned {
  SurfacePoint point;
  Ray ray;
};

Turned turned(const RayTracer& tracer, const Ray& ray, double eta) {
  const auto hit = tracer.nearest(ray);
  if (!hit) ADD_FAILURE() << "the ray meets nothing";
  Turned to{tracer.surface_point(ray, *hit), {}};
  const Vec3d n = dot(to.point.shading_normal, ray.direction) > 0 ? -to.point.shading_normal : to.point.shading_normal;
  const double cosine = -dot(ray.direction, n);
  if (eta == 0) {
    to.ray = leave(to.point, ray.direction + 2 * cosine * n);
  } else {
    const double beyond = std::sqrt(1 - eta * eta * (1 - cosine * cosine));
    to.ray = leave(to.point, eta * ray.direction + (eta * cosine - beyond) * n);
  }
  return to;
}

/// Compares the differential of a ray after some surfaces with the difference of two rays.
/// @param etas one a surface; 0 reflects.
void expect_as_by_difference(const Scene& scene, const Ray& ray, const RayDifferential& start,
                             const std::vector<double>& etas) {
  const RayTracer tracer(scene);
  Ray here = ray;
  RayDifferential differential = start;
  const auto neighbour = [&](double by) {
    return Ray{.origin = ray.origin + by * start.origin_x,
               .direction = normalize(ray.direction + by * start.direction_x)};
  };
  Ray before = neighbour(-h);
  Ray after = neighbour(h);
  for (const double eta : etas) {
    const Turned mine = turned(tracer, here, eta);
    const Turned one = turned(tracer, before, eta);
    const Turned other = turned(tracer, after, eta);
    const Footprint footprint = footprint_of(here, differential, mine.point);
    const Vec3d moved = (other.point.position - one.point.position) / (2 * h);
    EXPECT_LT(length(footprint.x - moved), 2e-3 * (1 + length(moved)));
    differential = eta == 0 ? reflected(tracer, here, differential, footprint, mine.point, mine.point.shading_normal)
                            : refracted(tracer, here, differential, footprint, mine.point, mine.point.shading_normal,
                                        mine.ray.direction, eta);
    const Vec3d turn = (other.ray.direction - one.ray.direction) / (2 * h);
    EXPECT_LT(length(differential.direction_x - turn), 5e-3 * (1 + length(turn)))
        << differential.direction_x.x << " " << differential.direction_x.y << " " << differential.direction_x.z
        << " against " << turn.x << " " << turn.y << " " << turn.z;
    here = mine.ray;
    before = one.ray;
    after = other.ray;
  }
}

RayDifferential of_eye(const Ray& ray, const Vec3d& step) {
  const Vec3d turn = step - dot(step, ray.direction) * ray.direction;
  return {.direction_x = turn, .direction_y = cross(ray.direction, turn)};
}

Scene with_shape(const Shape& shape) {
  Scene scene;
  scene.materials.emplace_back();
  scene.shapes.push_back({"shape", shape, 0});
  return scene;
}

TEST(RayDifferential, ReflectionByAFlatMirrorOnlyMovesIt) {
  const Ray ray{.origin = {0, 2, 0}, .direction = normalize(Vec3d(1, -1, 0.4))};
  expect_as_by_difference(with_shape(Plane{{0, 0, 0}, {0, 1, 0}}), ray, of_eye(ray, {0.3, 0.1, 0.7}), {0});
}

TEST(RayDifferential, ASphereMagnifies) {
  const Ray ray{.origin = {0.3, 0.4, 5}, .direction = {0, 0, -1}};
  for (const Vec3d step : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0.4, -0.7, 0)}) {
    expect_as_by_difference(with_shape(Sphere{{0, 0, 0}, 1}), ray, of_eye(ray, 0.1 * step), {0});
    expect_as_by_difference(with_shape(Sphere{{0, 0, 0}, 1}), ray, of_eye(ray, 0.1 * step), {1 / 1.5, 1.5});
    expect_as_by_difference(with_shape(Sphere{{0, 0, 0}, 1}), ray, of_eye(ray, 0.1 * step), {1 / 1.5, 0, 1.5});
  }
}

// Head-on, where the two directions do not tell the index.
TEST(RayDifferential, RefractionHeadOn) {
  const Ray ray{.origin = {0, 0, 5}, .direction = {0, 0, -1}};
  expect_as_by_difference(with_shape(Sphere{{0, 0, 0}, 1}), ray, of_eye(ray, {0.1, 0, 0}), {1 / 1.5, 1.5});
}

TEST(RayDifferential, ACylinderMagnifiesAcross) {
  const Ray ray{.origin = {0.3, 0.4, 5}, .direction = normalize(Vec3d(0.02, 0.1, -1))};
  for (const Vec3d step : {Vec3d(1, 0, 0), Vec3d(0, 1, 0)}) {
    expect_as_by_difference(with_shape(Cylinder{{0, -2, 0}, {0, 2, 0}, 1}), ray, of_eye(ray, 0.1 * step), {0});
  }
}

// Interpolated normals bend a flat triangle's reflection, also when it is placed askew or mirrored.
TEST(RayDifferential, InterpolatedNormalsMagnify) {
  Mesh mesh;
  mesh.positions = {{-2, -2, 0}, {2, -2, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.normals = {Vec3f(glm::normalize(Vec3d(-0.3, -0.3, 1))), Vec3f(glm::normalize(Vec3d(0.4, -0.2, 1))),
                  Vec3f(glm::normalize(Vec3d(0, 0.5, 1)))};
  mesh.uv[0] = {{0, 0}, {1, 0}, {0.5F, 1}};
  for (const double mirror : {1.0, -1.0}) {
    Scene scene;
    scene.materials.emplace_back();
    scene.meshes = {mesh};
    Mat4d placed(1.0);
    placed[0] = Vec4d(0.8 * mirror, 0.2, 0.1, 0);
    placed[2] = Vec4d(0.1, 0, 1.3, 0);
    placed[3] = Vec4d(0.1, 0.2, -0.3, 1);
    scene.instances.push_back({"triangle", 0, placed});
    const Ray ray{.origin = {0.2, 0.1, 3}, .direction = normalize(Vec3d(0.05, -0.05, -1))};
    expect_as_by_difference(scene, ray, of_eye(ray, {0.1, 0.03, 0}), {0});

    const RayTracer tracer(scene);
    const SurfacePoint point = tracer.surface_point(ray, *tracer.nearest(ray));
    const Ray beside{.origin = ray.origin + Vec3d(1e-3, 5e-4, 0), .direction = ray.direction};
    const SurfacePoint there = tracer.surface_point(beside, *tracer.nearest(beside));
    const SurfaceChange change = tracer.surface_change(point, there.position - point.position);
    EXPECT_LT(length(Vec2d(there.uv[0] - point.uv[0]) - change.uv[0]), 1e-6);
    EXPECT_LT(length(there.shading_normal - point.shading_normal - change.normal), 1e-6);
  }
}

}  // namespace
}  // namespace penumbra
