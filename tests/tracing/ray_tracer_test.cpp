#include "penumbra/tracing/ray_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tracing/soup.h"

namespace penumbra {
namespace {

using testing::as_float;
using testing::box;
using testing::Dice;
using testing::geodesic_sphere;
using testing::meet_plane;
using testing::random_placement;
using testing::random_soup;
using testing::rectangle;
using testing::scene_of;

constexpr double infinite = std::numeric_limits<double>::infinity();

Ray random_ray(Dice& dice, double reach) {
  const Vec3d origin = as_float(dice.cube(reach));
  return {.origin = origin, .direction = as_float(normalize(dice.cube(0.6 * reach) - origin))};
}

/// The nearest hit by brute force: between the nearest triangle that may be hit and the nearest that must be.
struct Bracket {
  double earliest = infinite, latest = infinite;
};

Bracket brute_force(const Mesh& mesh, const Ray& ray, double t_max = infinite) {
  constexpr double doubt = 1e-4;  // barycentric units from an edge
  Bracket b;
  for (const auto& [i, j, k] : mesh.triangles) {
    const auto hit = meet_plane(ray, mesh.positions[i], mesh.positions[j], mesh.positions[k]);
    if (!hit || hit->t < 1e-4 || hit->t > t_max || hit->margin() < -doubt) continue;
    b.earliest = std::min(b.earliest, hit->t);
    if (hit->margin() > doubt && hit->t > 2e-4) b.latest = std::min(b.latest, hit->t);
  }
  return b;
}

void expect_brute_force(const Mesh& mesh, double reach, int rays) {
  const Scene scene = scene_of(mesh);
  const RayTracer tracer(scene);
  Dice dice(11);
  int hits = 0;
  for (int i = 0; i < rays; ++i) {
    Ray ray = random_ray(dice, reach);
    ray.t_min = 1e-4;
    const Bracket truth = brute_force(mesh, ray);
    const auto hit = tracer.nearest(ray);
    const double t = hit ? hit->t : infinite;
    const double tolerance = 2e-5 * reach;  // triangles seen edge on shift t by more than one rounding
    ASSERT_GE(t, truth.earliest - tolerance);
    ASSERT_LE(t, truth.latest + tolerance);
    if (truth.latest < infinite) {
      ++hits;
      ray.t_max = truth.latest + tolerance;
      ASSERT_TRUE(tracer.occluded(ray));
    }
    if (truth.earliest < infinite) {
      ray.t_max = truth.earliest - tolerance;
      if (ray.t_max > ray.t_min) {
        ASSERT_FALSE(tracer.occluded(ray));
      }
    } else {
      ASSERT_FALSE(tracer.occluded(ray));
    }
  }
  EXPECT_GT(hits, rays / 10);
}

TEST(RayTracer, MeetsSoupsAsBruteForceDoes) {
  expect_brute_force(random_soup(300, 1, 0.4, 1), 2, 10000);
  expect_brute_force(random_soup(300, 100, 40, 2), 200, 5000);
}

TEST(RayTracer, MeetsSharedVertexMeshesAsBruteForceDoes) {
  expect_brute_force(geodesic_sphere({0.2, -0.1, 0.3}, 1, 3), 3, 10000);
}

TEST(RayTracer, CountsBoundsAndTriangles) {
  Scene scene = scene_of(box({-1, 0, 2}, {1, 3, 5}));
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].to_world[3] = {10, 0, 0, 1};
  const RayTracer tracer(scene);
  EXPECT_EQ(tracer.triangle_count(), 24U);
  EXPECT_LT(length(tracer.bounds().lower - Vec3d(-1, 0, 2)), 1e-12);
  EXPECT_LT(length(tracer.bounds().upper - Vec3d(11, 3, 5)), 1e-12);
}

TEST(RayTracer, AnEmptySceneStopsNothing) {
  const Scene scene;
  const RayTracer tracer(scene);
  const Ray ray;
  EXPECT_FALSE(tracer.nearest(ray));
  EXPECT_FALSE(tracer.occluded(ray));
}

// Through faces, edges and the neighbourhood of vertices; exactly at vertices Embree may let one in a thousand pass.
TEST(RayTracer, NothingEscapesAClosedMesh) {
  for (const auto& [centre, radius] : {std::pair{Vec3d(0), 1.0}, {Vec3d(300, -70, 20), 0.5}, {Vec3d(1, 2, 3), 1e4}}) {
    const Mesh mesh = geodesic_sphere(centre, radius, 4);
    const Scene scene = scene_of(mesh);
    const RayTracer tracer(scene);
    Dice dice(3);
    int slipped = 0;
    for (int i = 0; i < 70000; ++i) {
      const Vec3d origin = as_float(centre + 0.5 * radius * dice.direction());
      Vec3d aim = origin + dice.direction();
      const Mesh::Triangle& triangle = mesh.triangles[dice.below(mesh.triangles.size())];
      if (i % 3 == 1) aim = mesh.positions[triangle[0]];
      if (i % 3 == 2) aim = 0.5 * (mesh.positions[triangle[0]] + mesh.positions[triangle[1]]);
      const Ray ray{.origin = origin, .direction = normalize(aim - origin)};
      const bool met = tracer.nearest(ray).has_value();
      ASSERT_EQ(tracer.occluded(ray), met);
      slipped += met ? 0 : 1;
      ASSERT_TRUE(met || i % 3 == 1) << "radius " << radius << ", ray " << i;
    }
    EXPECT_LE(slipped, 23) << "radius " << radius;
  }
}

/// The same mesh placed several times, and all of it in world space as one mesh.
struct Placed {
  Scene instanced;
  Scene flat;
};

Placed place(const Mesh& mesh, const std::vector<Mat4d>& placements) {
  Placed p{scene_of(mesh), scene_of({})};
  p.instanced.instances.clear();
  Mesh& all = p.flat.meshes[0];
  for (const Mat4d& m : placements) {
    p.instanced.instances.push_back({"copy", 0, m});
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    for (const Vec3d& v : mesh.positions) all.positions.push_back(transform_point(m, v));
    const Mat3d turn = normal_matrix(m) * (is_mirroring(m) ? -1.0 : 1.0);
    for (const Vec3f& n : mesh.normals) all.normals.emplace_back(normalize(turn * Vec3d(n)));
    for (auto [a, b, c] : mesh.triangles) {
      if (is_mirroring(m)) std::swap(b, c);
      all.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return p;
}

TEST(RayTracer, InstancesAreTheirMeshesInTheWorld) {
  Mesh mesh = geodesic_sphere(Vec3d(0), 1, 2);
  for (const Vec3d& p : mesh.positions) mesh.normals.emplace_back(normalize(p));
  Dice dice(5);
  std::vector<Mat4d> placements;
  for (int i = 0; i < 6; ++i) placements.push_back(random_placement(dice, 4));
  for (const std::size_t copies : {std::size_t{1}, placements.size()}) {
    const Placed p = place(mesh, {placements.begin(), placements.begin() + static_cast<std::ptrdiff_t>(copies)});
    const RayTracer instanced(p.instanced);
    const RayTracer flat(p.flat);
    int hits = 0, missed_alone = 0;
    for (int i = 0; i < 20000; ++i) {
      const Ray ray = random_ray(dice, 8);
      const auto a = instanced.nearest(ray);
      const auto b = flat.nearest(ray);
      if (a.has_value() != b.has_value() || (a && std::abs(a->t - b->t) > 1e-4 * (1 + b->t))) {
        ++missed_alone;  // along a silhouette, by rounding
        continue;
      }
      if (!a) continue;
      ++hits;
      EXPECT_EQ(a->object, b->primitive / mesh.triangles.size());
      const SurfacePoint pa = instanced.surface_point(ray, *a);
      const SurfacePoint pb = flat.surface_point(ray, *b);
      ASSERT_LT(length(pa.position - pb.position), 2e-4);
      if (a->primitive == b->primitive % mesh.triangles.size()) {
        ASSERT_GT(dot(pa.geometric_normal, pb.geometric_normal), 1 - 1e-6);
      }
      ASSERT_GT(dot(pa.shading_normal, pb.shading_normal), 0.97);  // interpolated before or after turning
      ASSERT_GT(dot(pa.shading_normal, pa.geometric_normal), 0);
      // Convex and closed: seen from outside it shows its front.
      const Mat4d back = glm::inverse(p.instanced.instances[a->object].to_world);
      if (length(transform_point(back, ray.origin)) > 1) {
        ASSERT_LT(dot(pa.geometric_normal, ray.direction), 1e-5);
      }
    }
    EXPECT_GT(hits, 500);
    EXPECT_LE(missed_alone, 4);
  }
}

RayPacket pack(const std::vector<Ray>& rays, std::uint32_t asleep) {
  RayPacket packet{};
  for (int i = 0; i < RayPacket::size; ++i) {
    const Ray& r = rays[static_cast<std::size_t>(i)];
    packet.origin_x[i] = static_cast<float>(r.origin.x);
    packet.origin_y[i] = static_cast<float>(r.origin.y);
    packet.origin_z[i] = static_cast<float>(r.origin.z);
    packet.direction_x[i] = static_cast<float>(r.direction.x);
    packet.direction_y[i] = static_cast<float>(r.direction.y);
    packet.direction_z[i] = static_cast<float>(r.direction.z);
    packet.t_min[i] = static_cast<float>(r.t_min);
    packet.t_max[i] = static_cast<float>(r.t_max);
    packet.active[i] = (asleep >> i & 1) != 0 ? 0 : -1;
  }
  return packet;
}

Scene mixed_scene() {
  Scene scene = scene_of(random_soup(200, 1, 0.3, 7));
  Dice dice(9);
  scene.meshes.push_back(geodesic_sphere(Vec3d(0), 0.5, 2));
  for (int i = 0; i < 4; ++i) scene.instances.push_back({"copy", 1, random_placement(dice, 2)});
  scene.meshes.push_back(box(Vec3d(-0.3), Vec3d(0.3)));
  Mat4d mirror(1.0);
  mirror[0].x = -1;
  mirror[3] = {0, 1.5, 0, 1};
  scene.instances.push_back({"mirrored", 2, mirror});
  scene.shapes.push_back({"ball", Sphere{{1, -1, 0}, 0.6}, 0});
  scene.shapes.push_back({"pipe", Cylinder{{-1, -1, 0}, {-1, 1, 0.3}, 0.3}, 0});
  scene.shapes.push_back({"floor", Plane{{0, -2, 0}, {0, 1, 0}}, 0});
  return scene;
}

TEST(RayPackets, MeetWhatSingleRaysMeet) {
  const Scene scene = mixed_scene();
  const RayTracer tracer(scene);
  Dice dice(13);
  int hits = 0, differing = 0;
  for (int n = 0; n < 2000; ++n) {
    std::vector<Ray> rays;
    for (int i = 0; i < RayPacket::size; ++i) rays.push_back(random_ray(dice, 3));
    const auto asleep = static_cast<std::uint32_t>(dice.unit() * 65536);
    const RayPacket packet = pack(rays, n % 2 == 0 ? 0 : asleep);
    HitPacket found;
    tracer.nearest(packet, found);
    for (int i = 0; i < RayPacket::size; ++i) {
      const Ray& ray = rays[static_cast<std::size_t>(i)];
      const auto single = packet.active[i] != 0 ? tracer.nearest(ray) : std::nullopt;
      if (!single) {
        ASSERT_EQ(found.object[i], HitPacket::no_hit);
        continue;
      }
      ++hits;
      if (found.object[i] != single->object || found.primitive[i] != single->primitive) {
        ++differing;  // an edge between two triangles
        continue;
      }
      ASSERT_NEAR(found.t[i], single->t, 1e-5 * (1 + single->t));
      const SurfacePoint p = tracer.surface_point(ray, *single);
      const Vec3d normal(found.normal_x[i], found.normal_y[i], found.normal_z[i]);
      ASSERT_GT(dot(normalize(normal), p.geometric_normal), 1 - 1e-5) << "object " << single->object;
      if (single->object < scene.instances.size()) {
        ASSERT_NEAR(found.u[i], single->barycentric.x, 1e-4);
        ASSERT_NEAR(found.v[i], single->barycentric.y, 1e-4);
      }
    }
  }
  EXPECT_GT(hits, 10000);
  EXPECT_LE(differing, hits / 5000);
}

TEST(RayPackets, AreStoppedWhereSingleRaysAre) {
  const Scene scene = mixed_scene();
  const RayTracer tracer(scene);
  Dice dice(17);
  int stopped = 0, free = 0, differing = 0;
  for (int n = 0; n < 2000; ++n) {
    std::vector<Ray> rays;
    for (int i = 0; i < RayPacket::size; ++i) {
      rays.push_back(random_ray(dice, 2));
      rays.back().t_max = dice.between(0.1, 3);
    }
    const RayPacket before = pack(rays, static_cast<std::uint32_t>(dice.unit() * 65536));
    RayPacket after = before;
    tracer.occluded(after, n % 2 == 0);
    for (int i = 0; i < RayPacket::size; ++i) {
      if (before.active[i] == 0) {
        ASSERT_EQ(after.active[i], 0);
        continue;
      }
      const bool single = tracer.occluded(rays[static_cast<std::size_t>(i)]);
      differing += single != (after.active[i] == 0) ? 1 : 0;
      (single ? stopped : free)++;
    }
  }
  EXPECT_GT(stopped, 1000);
  EXPECT_GT(free, 1000);
  EXPECT_LE(differing, 2);
}

/// A square in the plane z = 0 with alpha 0 in one half of its texture (u < 0.5).
Scene half_hole(AlphaMode mode) {
  Scene scene = scene_of(rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  scene.images.push_back({"hole", 2, 1, 4, std::vector<std::uint8_t>{255, 255, 255, 0, 255, 255, 255, 255}});
  Texture texture;
  texture.filter = TexelFilter::nearest;
  scene.textures.push_back(texture);
  scene.materials[0].base_colour_texture = TextureRef{};
  scene.materials[0].alpha_mode = mode;
  return scene;
}

void expect_hole(const RayTracer& tracer, double shift) {
  Dice dice(19);
  for (int i = 0; i < 200; ++i) {
    const Vec3d p(dice.between(-0.99, 0.99), dice.between(-0.99, 0.99), 1);
    const Ray ray{.origin = p + Vec3d(shift, 0, 0), .direction = {0, 0, -1}};
    EXPECT_EQ(tracer.nearest(ray).has_value(), p.x > 0) << p.x;
    EXPECT_EQ(tracer.occluded(ray), p.x > 0) << p.x;
    RayPacket packet = pack(std::vector<Ray>(RayPacket::size, ray), 0);
    HitPacket hits;
    tracer.nearest(packet, hits);
    EXPECT_EQ(hits.object[7] != HitPacket::no_hit, p.x > 0);
    tracer.occluded(packet, true);
    EXPECT_EQ(packet.active[7] == 0, p.x > 0);
  }
}

TEST(AlphaMask, RaysPassTheHole) {
  Scene scene = half_hole(AlphaMode::mask);
  expect_hole(RayTracer(scene), 0);
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].to_world[3] = {10, 0, 0, 1};
  const RayTracer instanced(scene);
  expect_hole(instanced, 0);
  expect_hole(instanced, 10);
}

TEST(AlphaMask, OtherModesStopRays) {
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::blend}) {
    const Scene scene = half_hole(mode);
    const RayTracer tracer(scene);
    EXPECT_TRUE(tracer.nearest({.origin = {-0.5, 0, 1}, .direction = {0, 0, -1}}));
  }
}

TEST(AlphaMask, VertexAlphaAndCutoffCount) {
  Scene scene = scene_of(rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  scene.meshes[0].colours = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};  // alpha = x
  scene.materials[0].alpha_mode = AlphaMode::mask;
  scene.materials[0].alpha_cutoff = 0.3F;
  const RayTracer tracer(scene);
  for (const double x : {0.1, 0.29, 0.31, 0.9}) {
    EXPECT_EQ(tracer.occluded({.origin = {x, 0.4, 1}, .direction = {0, 0, -1}}), x > 0.3) << x;
  }
}

}  // namespace
}  // namespace penumbra
