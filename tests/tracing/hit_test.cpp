#include "penumbra/tracing/hit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/tracing/ray_tracer.h"
#include "tracing/soup.h"

namespace penumbra {
namespace {

using testing::as_float;
using testing::box;
using testing::Dice;
using testing::meet_plane;
using testing::random_placement;
using testing::rectangle;
using testing::scene_of;

Mesh random_triangle(Dice& dice, const Vec3d& centre, double size) {
  Mesh mesh;
  for (int c = 0; c < 3; ++c) mesh.positions.push_back(centre + dice.cube(size));
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// A direction at the angle to the normal whose cosine is `cosine`, around it anywhere.
Vec3d direction_at(Dice& dice, const Vec3d& normal, double cosine) {
  const double phi = dice.between(0, 6.283185307179586);
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return normalize(Frame(normal).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine}));
}

/// Cosines from head-on to grazing beyond what single precision resolves, on both sides.
double random_cosine(Dice& dice) {
  const double cosine = std::min(1.0, dice.magnitude(-9, 0.1));
  return dice.unit() < 0.5 ? -cosine : cosine;
}

Hit random_hit(Dice& dice, std::uint32_t object, std::uint32_t primitive) {
  return {.t = 0, .object = object, .primitive = primitive, .barycentric = sample_triangle(dice.square())};
}

TEST(Leave, ARayNeverMeetsItsOwnTriangleAgain) {
  Dice dice(1);
  for (int n = 0; n < 3000; ++n) {
    const double size = dice.magnitude(-3, 5);
    const Vec3d centre = n % 3 == 0 ? Vec3d(0) : dice.magnitude(-2, 5) * dice.direction();
    const Scene scene = scene_of(random_triangle(dice, centre, size));
    const RayTracer tracer(scene);
    for (int i = 0; i < 20; ++i) {
      const SurfacePoint p = tracer.surface_point({}, random_hit(dice, 0, 0));
      const double cosine = random_cosine(dice);
      const Ray ray = leave(p, direction_at(dice, p.geometric_normal, cosine));
      ASSERT_FALSE(tracer.nearest(ray)) << "size " << size << ", distance " << length(centre) << ", cosine " << cosine;
      ASSERT_FALSE(tracer.occluded(ray));
    }
  }
}

// A mesh far from its own origin, placed near the world's, rounds by where it was, not by where it is.
TEST(Leave, ARayNeverMeetsItsOwnInstanceAgain) {
  Dice dice(2);
  for (int n = 0; n < 1500; ++n) {
    const Vec3d home = (n % 2 == 0 ? 1.0 : dice.magnitude(0, 5)) * dice.direction();
    Scene scene = scene_of(random_triangle(dice, home, 1));
    Mat4d placement = random_placement(dice, 5);
    if (n % 4 == 1) placement[3] = Vec4d(-Vec3d(Mat3d(placement) * home), 1);
    scene.instances[0].to_world = placement;
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].to_world[3] += Vec4d(0, 1e4, 0, 0);
    const RayTracer tracer(scene);
    for (int i = 0; i < 20; ++i) {
      const SurfacePoint p = tracer.surface_point({}, random_hit(dice, 0, 0));
      const Ray ray = leave(p, direction_at(dice, p.geometric_normal, random_cosine(dice)));
      const auto hit = tracer.nearest(ray);
      ASSERT_FALSE(hit && hit->object == 0) << "home at " << length(home) << ", placement " << n % 4;
    }
  }
}

TEST(Leave, ARayNeverMeetsItsOwnShapeAgain) {
  Dice dice(3);
  for (int n = 0; n < 4000; ++n) {
    const double radius = dice.magnitude(-3, 4);
    const Vec3d centre = n % 2 == 0 ? Vec3d(0) : dice.magnitude(-2, 4) * dice.direction();
    Scene scene;
    scene.materials.emplace_back();
    if (n % 3 == 0) scene.shapes.push_back({"", Sphere{centre, radius}, 0});
    if (n % 3 == 1) scene.shapes.push_back({"", Disk{centre, dice.direction(), radius}, 0});
    if (n % 3 == 2) scene.shapes.push_back({"", Cylinder{centre, centre + radius * dice.direction(), radius}, 0});
    const RayTracer tracer(scene);
    for (int i = 0; i < 20; ++i) {
      const Vec3d eye = centre + 3 * radius * dice.direction();
      const Ray towards{.origin = eye, .direction = normalize(centre + 0.3 * radius * dice.direction() - eye)};
      const auto hit = tracer.nearest(towards);
      if (!hit) continue;
      const SurfacePoint p = tracer.surface_point(towards, *hit);
      // Away from the bulge of a sphere or cylinder there is nothing; a disk is free on both sides.
      const double cosine = n % 3 == 1 ? random_cosine(dice) : std::abs(random_cosine(dice));
      const Ray ray = leave(p, direction_at(dice, p.geometric_normal, cosine));
      const auto again = tracer.nearest(ray);
      if (n % 3 == 2 && again && dot(tracer.surface_point(ray, *again).geometric_normal, ray.direction) > 0) {
        ADD_FAILURE() << "went through the cylinder's wall";
      }
      ASSERT_FALSE(again) << "shape " << n % 3 << ", radius " << radius << ", distance " << length(centre)
                          << ", cosine " << cosine;
    }
  }
}

TEST(Leave, InsideASphereTheOtherWallIsMet) {
  Dice dice(4);
  for (int n = 0; n < 300; ++n) {
    const double radius = dice.magnitude(-2, 3);
    Scene scene;
    scene.materials.emplace_back();
    scene.shapes.push_back({"", Sphere{radius * dice.cube(3), radius}, 0});
    const RayTracer tracer(scene);
    const Vec3d centre = std::get<Sphere>(scene.shapes[0].shape).centre;
    const Ray towards{.origin = centre, .direction = dice.direction()};
    const SurfacePoint p = tracer.surface_point(towards, tracer.nearest(towards).value());
    const double cosine = dice.between(0.05, 1);
    const auto hit = tracer.nearest(leave(p, direction_at(dice, -p.geometric_normal, cosine)));
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 2 * radius * cosine, 1e-3 * radius);
  }
}

/// A point on a random triangle of the mesh, off its edges: in a corner, rounding can put it beyond the next face.
SurfacePoint point_on(const RayTracer& tracer, Dice& dice) {
  const std::size_t triangles = tracer.scene().meshes[0].triangles.size();
  Hit hit = random_hit(dice, 0, static_cast<std::uint32_t>(dice.below(triangles)));
  hit.barycentric = glm::mix(Vec2d(1.0 / 3), hit.barycentric, 0.9);
  return tracer.surface_point({}, hit);
}

TEST(Segment, FacesOfAConvexRoomSeeEachOther) {
  Dice dice(5);
  for (int n = 0; n < 300; ++n) {
    // From cubes to rooms a few ten-thousandths of their length high: most lines graze both ends.
    const double flatness = dice.magnitude(-3.5, 0);
    const double size = dice.magnitude(-2, 3);
    const Vec3d corner = size * dice.cube(3);
    Mesh mesh = box(corner, corner + size * Vec3d(1, flatness, dice.between(0.3, 1)));
    const Frame turn(n % 2 == 0 ? Vec3d(0, 0, 1) : dice.direction());
    for (Vec3d& p : mesh.positions) p = turn.to_world(p);
    const Scene scene = scene_of(mesh);
    const RayTracer tracer(scene);
    for (int i = 0; i < 300; ++i) {
      const SurfacePoint a = point_on(tracer, dice);
      const SurfacePoint b = point_on(tracer, dice);
      if (a.primitive / 2 == b.primitive / 2) continue;
      ASSERT_FALSE(tracer.occluded(segment(a, b)))
          << "flatness " << flatness << ", size " << size << ", faces " << a.primitive / 2 << " " << b.primitive / 2;
    }
  }
}

// The end of a long segment is as uncertain as the segment is long, however small the coordinates there.
TEST(Segment, ReachesASmallLampFromFarAlongItsFace) {
  Dice dice(6);
  for (int n = 0; n < 3000; ++n) {
    const double distance = dice.magnitude(0, 4);
    const Vec3d normal = dice.direction();
    const Frame frame(normal);
    const Vec3d lamp_centre = 0.1 * dice.direction();
    Mesh mesh;
    const Vec3d way = direction_at(dice, normal, std::min(1.0, dice.magnitude(-6, 0)));  // seen from the lamp
    const Frame floor(n % 2 == 0 ? -way : direction_at(dice, -way, dice.between(0.01, 1)));
    for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1, -1}, {0, 1}}) {
      mesh.positions.push_back(lamp_centre + 0.1 * (x * frame.tangent + y * frame.bitangent));
    }
    for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1, -1}, {0, 1}}) {
      mesh.positions.push_back(lamp_centre + distance * way +
                               1e-3 * distance * (x * floor.tangent + y * floor.bitangent));
    }
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    const Scene scene = scene_of(mesh);
    const RayTracer tracer(scene);
    for (int i = 0; i < 10; ++i) {
      const SurfacePoint lamp = tracer.surface_point({}, random_hit(dice, 0, 0));
      const SurfacePoint far = tracer.surface_point({}, random_hit(dice, 0, 1));
      ASSERT_FALSE(tracer.occluded(segment(far, lamp))) << "distance " << distance;
      ASSERT_FALSE(tracer.occluded(segment(lamp, far))) << "distance " << distance;
    }
  }
}

TEST(Segment, AThinBlockerBlocks) {
  Dice dice(7);
  for (int n = 0; n < 2000; ++n) {
    const double size = dice.magnitude(-2, 3);
    const Vec3d centre = n % 2 == 0 ? Vec3d(0) : 10 * size * dice.direction();
    Mesh mesh = random_triangle(dice, centre, size);
    const Mesh other = random_triangle(dice, centre + 5 * size * dice.direction(), size);
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    mesh.triangles.push_back({3, 4, 5});
    const Hit at_a = random_hit(dice, 0, 0), at_b = random_hit(dice, 0, 1);
    const Scene open = scene_of(mesh);
    const RayTracer free(open);
    const SurfacePoint a = free.surface_point({}, at_a), b = free.surface_point({}, at_b);
    const Ray line = segment(a, b);
    if (free.occluded(line)) continue;  // one shades the other
    const double where = dice.unit() < 0.5 ? dice.magnitude(-3, -0.31) : 1 - dice.magnitude(-3, -0.31);
    const Frame frame(direction_at(dice, line.direction, dice.between(0.2, 1)));
    const Vec3d middle = glm::mix(a.position, b.position, where);
    const double reach = 0.01 * size;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(middle - reach * (frame.tangent + frame.bitangent));
    mesh.positions.push_back(middle + reach * (2.0 * frame.tangent - frame.bitangent));
    mesh.positions.push_back(middle + reach * (2.0 * frame.bitangent - frame.tangent));
    mesh.triangles.push_back({first, first + 1, first + 2});
    const Scene blocked = scene_of(mesh);
    ASSERT_TRUE(RayTracer(blocked).occluded(line)) << "at " << where << " of the way, size " << size;
  }
}

TEST(Segment, ToAPointEndsAtIt) {
  const Scene scene = scene_of(rectangle({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
  const RayTracer tracer(scene);
  const SurfacePoint p = tracer.surface_point({}, {.barycentric = {0.3, 0.3}});
  const Vec3d target(0.5, 3, -2);
  const Ray ray = segment(p, target);
  EXPECT_NEAR(length(ray.direction), 1, 1e-12);
  EXPECT_LT(length(ray.at(ray.t_max) - target), 1e-5);
  EXPECT_LT(ray.t_max, length(target - ray.origin));
}

TEST(SurfacePoint, AttributesAreInterpolated) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 0, -1}};
  mesh.triangles = {{0, 1, 2}};
  mesh.uv[0] = {{0, 1}, {1, 1}, {0, 0}};
  mesh.uv[1] = {{5, 5}, {6, 5}, {5, 9}};
  mesh.colours = {{1, 0, 0, 1}, {0, 1, 0, 0.5F}, {0, 0, 1, 0}};
  mesh.normals = {Vec3f(0, 1, 0), normalize(Vec3f(1, 1, 0)), Vec3f(0, 1, 0)};
  mesh.materials = {0};
  const Scene scene = scene_of(mesh);
  const RayTracer tracer(scene);
  const Ray ray{.origin = {0.5, 3, -0.25}, .direction = {0, -1, 0}};
  const SurfacePoint p = tracer.surface_point(ray, tracer.nearest(ray).value());
  EXPECT_LT(length(p.position - Vec3d(0.5, 0, -0.25)), 1e-6);
  EXPECT_LT(length(p.geometric_normal - Vec3d(0, 1, 0)), 1e-12);
  EXPECT_LT(length(p.uv[0] - Vec2f(0.25F, 0.75F)), 1e-6F);
  EXPECT_LT(length(p.uv[1] - Vec2f(5.25F, 6.0F)), 1e-5F);
  EXPECT_LT(glm::length(p.colour - Vec4f(0.5F, 0.25F, 0.25F, 0.625F)), 1e-6F);
  const double lean = 0.25 * std::sqrt(0.5);
  EXPECT_LT(length(p.shading_normal - normalize(Vec3d(lean, 0.75 + lean, 0))), 1e-6);
  EXPECT_NEAR(dot(p.tangent, p.shading_normal), 0, 1e-12);
  EXPECT_GT(p.tangent.x, 0.9);
  EXPECT_LT(p.bitangent.z, -0.9) << "v falls along -z, and +Y of a normal map is against v";
}

// Tangent along growing u, bitangent against growing v, for textures and placements of either hand.
TEST(SurfacePoint, TangentsFollowTheTextureThroughMirrors) {
  Dice dice(8);
  int mirrored = 0;
  for (int n = 0; n < 500; ++n) {
    Mesh mesh = random_triangle(dice, Vec3d(0), 1);
    for (int c = 0; c < 3; ++c) mesh.uv[0].emplace_back(dice.square());
    const Mat4d placement = random_placement(dice, 1);
    mirrored += is_mirroring(placement) ? 1 : 0;
    const Scene scene = scene_of(mesh, placement);
    const RayTracer tracer(scene);
    const SurfacePoint p = tracer.surface_point({}, random_hit(dice, 0, 0));
    const Vec3d v0 = transform_point(placement, mesh.positions[0]);
    const Vec3d e1 = transform_point(placement, mesh.positions[1]) - v0;
    const Vec3d e2 = transform_point(placement, mesh.positions[2]) - v0;
    const Vec2d d1(mesh.uv[0][1] - mesh.uv[0][0]), d2(mesh.uv[0][2] - mesh.uv[0][0]);
    const double determinant = d1.x * d2.y - d1.y * d2.x;
    if (std::abs(determinant) < 1e-3) continue;
    const Vec3d along_u = (d2.y * e1 - d1.y * e2) / determinant;
    const Vec3d along_v = (d1.x * e2 - d2.x * e1) / determinant;
    ASSERT_GT(dot(p.tangent, normalize(along_u)), 1 - 1e-9);
    ASSERT_GT(dot(p.bitangent, -along_v), 0);
    ASSERT_NEAR(dot(p.bitangent, p.tangent), 0, 1e-9);
    ASSERT_NEAR(dot(p.bitangent, p.geometric_normal), 0, 1e-9);
    // Counter-clockwise in the mesh is the front, also in a mirror.
    ASSERT_GT(dot(p.geometric_normal, cross(e1, e2)) * (is_mirroring(placement) ? -1 : 1), 0);
  }
  EXPECT_GT(mirrored, 150);
}

TEST(SurfacePoint, TangentsOfTheMeshKeepTheirHand) {
  for (const float hand : {1.0F, -1.0F}) {
    for (const double flip : {1.0, -1.0}) {
      Mesh mesh;
      mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
      mesh.triangles = {{0, 1, 2}};
      mesh.normals.assign(3, Vec3f(0, 0, 1));
      mesh.tangents.assign(3, Vec4f(1, 0, 0, hand));  // so the bitangent is +y hand in the mesh
      Mat4d placement(1.0);
      placement[1].y = flip;
      const Scene scene = scene_of(mesh, placement);
      const RayTracer tracer(scene);
      const SurfacePoint p = tracer.surface_point({}, {.barycentric = {0.2, 0.2}});
      EXPECT_LT(length(p.tangent - Vec3d(1, 0, 0)), 1e-12);
      EXPECT_LT(length(p.bitangent - Vec3d(0, hand * flip, 0)), 1e-12);
      EXPECT_LT(length(p.shading_normal - Vec3d(0, 0, 1)), 1e-12) << "front stays front in a mirror";
    }
  }
}

TEST(SurfacePoint, TheErrorBoundHolds) {
  Dice dice(9);
  int hits = 0;
  for (int n = 0; n < 3000; ++n) {
    const double size = dice.magnitude(-2, 4);
    const Vec3d centre = n % 2 == 0 ? Vec3d(0) : size * dice.magnitude(-1, 2) * dice.direction();
    const Mesh mesh = random_triangle(dice, centre, size);
    const Scene scene = scene_of(mesh);
    const RayTracer tracer(scene);
    const Vec3d aim = tracer.surface_point({}, random_hit(dice, 0, 0)).position;
    const Vec3d origin = as_float(aim + size * dice.direction());
    const Ray ray{.origin = origin, .direction = as_float(normalize(aim - origin))};
    const auto hit = tracer.nearest(ray);
    if (!hit) continue;
    const SurfacePoint p = tracer.surface_point(ray, *hit);
    const auto truth = meet_plane(ray, mesh.positions[0], mesh.positions[1], mesh.positions[2]);
    const Vec3d met = ray.at(truth->t);
    // Across the surface it always holds; along it as far as the ray does not graze it.
    ASSERT_LE(std::abs(dot(met - p.position, p.geometric_normal)), dot(p.error, glm::abs(p.geometric_normal)));
    const double cosine = std::abs(dot(ray.direction, p.geometric_normal));
    const double sliver =
        length(cross(mesh.positions[1] - mesh.positions[0], mesh.positions[2] - mesh.positions[0])) / (size * size);
    if (cosine < 0.3 || sliver < 0.3) continue;
    ++hits;
    for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(met[k] - p.position[k]), p.error[k] / cosine);
  }
  EXPECT_GT(hits, 300);
}

}  // namespace
}  // namespace penumbra
