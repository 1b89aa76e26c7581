// Sixteen differentials side by side are those of the scalar functions.

#include "penumbra/render/packet_differentials.h"

#include <gtest/gtest.h>

#include "penumbra/math/rng.h"
#include "penumbra/tracing/ray_differential.h"
#include "penumbra/tracing/shading/checker.h"
#include "render/probe.h"

namespace penumbra {
namespace {

constexpr std::size_t n = RayPacket::size;

/// Rays of random differentials that meet a sphere or a plane, in both forms.
struct Meetings {
  Scene scene;
  std::vector<Ray> rays;
  std::vector<RayDifferential> differentials;
  std::vector<SurfacePoint> points;
  RayPacket packet{};
  DifferentialLanes lanes{};
  PointLanes at{};
  Lanes curvature{};
};

Vec3d lane(const VectorLanes& v, std::size_t i) { return {v.x[i], v.y[i], v.z[i]}; }

Meetings meet(const Shape& shape, double curvature) {
  Meetings m;
  testing::add_shape(m.scene, shape, testing::matt(Rgb(0.5F)));
  const RayTracer tracer(m.scene);
  CounterRng random(7);
  const auto cube = [&] { return Vec3d(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5); };
  while (m.rays.size() < n) {
    const Vec3d origin = Vec3d(0, 3, 0) + cube();
    const Ray ray{.origin = origin, .direction = normalize(Vec3d(0, 0, 0) + cube() - origin)};
    const auto hit = tracer.nearest(ray);
    if (!hit) continue;
    const std::size_t i = m.rays.size();
    const RayDifferential d{0.01 * cube(), 0.01 * cube(), 0.01 * cube(), 0.01 * cube()};
    m.rays.push_back(ray);
    m.differentials.push_back(d);
    m.points.push_back(tracer.surface_point(ray, *hit));
    const SurfacePoint& p = m.points.back();
    m.packet.origin_x[i] = static_cast<float>(ray.origin.x);
    m.packet.origin_y[i] = static_cast<float>(ray.origin.y);
    m.packet.origin_z[i] = static_cast<float>(ray.origin.z);
    m.packet.direction_x[i] = static_cast<float>(ray.direction.x);
    m.packet.direction_y[i] = static_cast<float>(ray.direction.y);
    m.packet.direction_z[i] = static_cast<float>(ray.direction.z);
    const int k = static_cast<int>(i);
    m.lanes.origin_x.set(k, Vec3f(d.origin_x));
    m.lanes.origin_y.set(k, Vec3f(d.origin_y));
    m.lanes.direction_x.set(k, Vec3f(d.direction_x));
    m.lanes.direction_y.set(k, Vec3f(d.direction_y));
    m.at.position.set(k, Vec3f(p.position));
    m.at.geometric.set(k, Vec3f(p.geometric_normal));
    m.at.normal.set(k, Vec3f(p.shading_normal));
    m.at.front[i] = 1;
    m.at.facing[i] = static_cast<float>(-dot(p.shading_normal, ray.direction));
    m.curvature[i] = static_cast<float>(curvature);
  }
  return m;
}

void expect_near(const Vec3d& a, const Vec3d& b) { EXPECT_LT(length(a - b), 2e-3 * length(b) + 1e-6); }

void expect_the_scalar_ones(const Shape& shape, double curvature) {
  const Meetings m = meet(shape, curvature);
  const RayTracer tracer(m.scene);
  FootprintLanes footprints, changes;
  DifferentialLanes mirrored, bent;
  Lanes ior;
  ior.fill(1.5F);
  BounceLanes reflected_rays, refracted_rays;
  split_rays(m.packet, m.at, ior, reflected_rays, refracted_rays);
  find_footprints(m.packet, m.lanes, m.at, footprints);
  bend_normals(m.at, m.curvature, footprints, changes);
  reflect_differentials(m.packet, m.at, m.lanes, footprints, changes, mirrored);
  refract_differentials(m.packet, m.at, m.lanes, footprints, changes, refracted_rays, ior, bent);
  for (std::size_t i = 0; i < n; ++i) {
    const SurfacePoint& p = m.points[i];
    const Footprint f = footprint_of(m.rays[i], m.differentials[i], p);
    expect_near(lane(footprints.x, i), f.x);
    expect_near(lane(footprints.y, i), f.y);
    const RayDifferential r = reflected(tracer, m.rays[i], m.differentials[i], f, p, p.shading_normal);
    expect_near(lane(mirrored.origin_x, i), r.origin_x);
    expect_near(lane(mirrored.direction_x, i), r.direction_x);
    expect_near(lane(mirrored.direction_y, i), r.direction_y);
    const RayDifferential t = refracted(tracer, m.rays[i], m.differentials[i], f, p, p.shading_normal,
                                        normalize(lane(refracted_rays.direction, i)), 1 / 1.5);
    expect_near(lane(bent.direction_x, i), t.direction_x);
    expect_near(lane(bent.direction_y, i), t.direction_y);
  }
}

TEST(PacketDifferentials, OnASphereAreThoseOfTheScalarFunctions) {
  expect_the_scalar_ones(Sphere{{0, 0, 0}, 0.9}, 1 / 0.9);
}

TEST(PacketDifferentials, OnAPlaneAreThoseOfTheScalarFunctions) {
  expect_the_scalar_ones(Plane{{0, 0.1, 0}, normalize(Vec3d(0.2, 1, 0.1))}, 0);
}

// From footprints far smaller than a square to far larger ones, near the origin and far from it.
TEST(PacketDifferentials, ChequersAreAveragedAsOneByOne) {
  CounterRng random(11);
  for (const double size : {1e-4, 0.05, 0.5, 3.0, 40.0}) {
    for (const double far : {0.0, 100.0}) {
      PointLanes points{};
      FootprintLanes footprints{};
      Lanes inverse{}, shares{};
      std::vector<float> expected;
      for (std::size_t i = 0; i < n; ++i) {
        const int k = static_cast<int>(i);
        const auto cube = [&] { return Vec3d(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5); };
        SurfacePoint p;
        p.geometric_normal = normalize(cube());
        p.position = Vec3d(Vec3f(Vec3d(far) + 4.0 * cube()));
        const Footprint f{Vec3d(Vec3f(size * cube())), Vec3d(Vec3f(size * cube()))};
        points.position.set(k, Vec3f(p.position));
        points.geometric.set(k, Vec3f(p.geometric_normal));
        footprints.x.set(k, Vec3f(f.x));
        footprints.y.set(k, Vec3f(f.y));
        inverse[i] = i % 5 == 4 ? 0.0F : 1 / 0.5F;  // lanes without a chequer do not matter
        expected.push_back(second_colour_share(p, 0.5, f));
      }
      average_checkers(points, inverse, footprints, shares);
      for (std::size_t i = 0; i < n; ++i) {
        if (inverse[i] == 0) continue;
        EXPECT_NEAR(shares[i], expected[i], 2e-3) << size << " " << far << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
