#include "penumbra/tracing/ray_differential.h"

#include <cmath>

namespace penumbra {
namespace {

// Of a step over the surface, the change of the normal about which light is sent on. A normal map's own bends are left
// out; the normal may be turned against the surface's.
Vec3d normal_change(const RayTracer& tracer, const SurfacePoint& point, const Vec3d& normal, const Vec3d& step) {
  const Vec3d change = tracer.surface_change(point, step).normal;
  return dot(normal, point.shading_normal) < 0 ? -change : change;
}

}  // namespace

Footprint footprint_of(const Ray& ray, const RayDifferential& differential, const SurfacePoint& point) {
  const double t = dot(point.position - ray.origin, ray.direction);
  const double slope = dot(ray.direction, point.geometric_normal);
  const auto met = [&](const Vec3d& origin, const Vec3d& direction) {
    const Vec3d across = origin + t * direction;
    return across - dot(across, point.geometric_normal) / slope * ray.direction;
  };
  return {met(differential.origin_x, differential.direction_x), met(differential.origin_y, differential.direction_y)};
}

RayDifferential passed_on(const RayDifferential& differential, const Footprint& footprint) {
  return {footprint.x, footprint.y, differential.direction_x, differential.direction_y};
}

// D' = D - 2 (D.N) N, differentiated.
RayDifferential reflected(const RayTracer& tracer, const Ray& ray, const RayDifferential& differential,
                          const Footprint& footprint, const SurfacePoint& point, const Vec3d& normal) {
  const Vec3d& d = ray.direction;
  const auto turned = [&](const Vec3d& d_change, const Vec3d& step) {
    const Vec3d n_change = normal_change(tracer, point, normal, step);
    return d_change - 2.0 * (dot(d, normal) * n_change + (dot(d_change, normal) + dot(d, n_change)) * normal);
  };
  return {footprint.x, footprint.y, turned(differential.direction_x, footprint.x),
          turned(differential.direction_y, footprint.y)};
}

// D' = eta D - mu N with N towards where the ray comes from, and mu = eta D.N - D'.N, differentiated.
RayDifferential refracted(const RayTracer& tracer, const Ray& ray, const RayDifferential& differential,
                          const Footprint& footprint, const SurfacePoint& point, const Vec3d& normal,
                          const Vec3d& direction, double eta) {
  const Vec3d& d = ray.direction;
  const Vec3d n = dot(d, normal) > 0 ? -normal : normal;
  const double before = length(cross(d, n));
  if (before > 1e-3) eta = length(cross(direction, n)) / before;  // Snell
  const double cosine = dot(d, n);
  const double cosine_beyond = dot(direction, n);
  const double mu = eta * cosine - cosine_beyond;
  const double mu_slope = eta - eta * eta * cosine / cosine_beyond;
  const auto turned = [&](const Vec3d& d_change, const Vec3d& step) {
    const Vec3d n_change = normal_change(tracer, point, n, step);
    const double cosine_change = dot(d_change, n) + dot(d, n_change);
    return eta * d_change - mu * n_change - mu_slope * cosine_change * n;
  };
  return {footprint.x, footprint.y, turned(differential.direction_x, footprint.x),
          turned(differential.direction_y, footprint.y)};
}

}  // namespace penumbra
