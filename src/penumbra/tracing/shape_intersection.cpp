#include "penumbra/tracing/shape_intersection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "penumbra/math/frame.h"

namespace penumbra {
namespace {

using std::numbers::pi;

bool within(const Ray& ray, double t) { return t > ray.t_min && t < ray.t_max; }

// The roots of a t^2 + 2 b t + c, smaller first, without cancellation.
std::optional<std::pair<double, double>> roots(double a, double b, double c, double discriminant) {
  if (discriminant < 0 || a == 0) return std::nullopt;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  const double r0 = q / a;
  const double r1 = q == 0 ? r0 : c / q;
  return std::pair{std::min(r0, r1), std::max(r0, r1)};
}

}  // namespace

std::optional<double> intersect(const Sphere& sphere, const Ray& ray) {
  // The discriminant by the distance of the centre from the ray, which keeps its digits when the sphere is far
  // (Haines, Guenther, Akenine-Moeller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems 2019).
  const Vec3d f = ray.origin - sphere.centre;
  const double a = dot(ray.direction, ray.direction);
  const double b = dot(f, ray.direction);
  const Vec3d foot = f - (b / a) * ray.direction;
  const double r2 = sphere.radius * sphere.radius;
  const double discriminant = a * (r2 - dot(foot, foot));
  const auto t = roots(a, b, dot(f, f) - r2, discriminant);
  if (!t) return std::nullopt;
  if (within(ray, t->first)) return t->first;
  if (within(ray, t->second)) return t->second;
  return std::nullopt;
}

std::optional<double> intersect(const Plane& plane, const Ray& ray) {
  const double slope = dot(plane.normal, ray.direction);
  if (slope == 0) return std::nullopt;
  const double t = dot(plane.point - ray.origin, plane.normal) / slope;
  return within(ray, t) ? std::optional(t) : std::nullopt;
}

std::optional<double> intersect(const Disk& disk, const Ray& ray) {
  const auto t = intersect(Plane{disk.centre, disk.normal}, ray);
  if (!t || length_squared(ray.at(*t) - disk.centre) > disk.radius * disk.radius) return std::nullopt;
  return t;
}

std::optional<double> intersect(const Cylinder& cylinder, const Ray& ray) {
  const Vec3d axis = cylinder.top - cylinder.base;
  const double axis2 = dot(axis, axis);
  const auto across = [&](const Vec3d& v) { return v - (dot(v, axis) / axis2) * axis; };
  const Vec3d f = across(ray.origin - cylinder.base);
  const Vec3d d = across(ray.direction);
  const double a = dot(d, d);
  if (a == 0) return std::nullopt;  // along the axis
  const double b = dot(f, d);
  const Vec3d foot = f - (b / a) * d;
  const double r2 = cylinder.radius * cylinder.radius;
  const auto t = roots(a, b, dot(f, f) - r2, a * (r2 - dot(foot, foot)));
  if (!t) return std::nullopt;
  for (const double candidate : {t->first, t->second}) {
    const double along = dot(ray.at(candidate) - cylinder.base, axis);
    if (within(ray, candidate) && along >= 0 && along <= axis2) return candidate;
  }
  return std::nullopt;
}

namespace {

double turn(double y, double x) {
  const double angle = std::atan2(y, x) / (2 * pi);
  return angle < 0 ? angle + 1 : angle;
}

ShapePoint point_on(const Sphere& sphere, const Vec3d& near, bool with_uv) {
  const Vec3d offset = near - sphere.centre;
  const Vec3d n = length_squared(offset) > 0 ? normalize(offset) : Vec3d(0, 1, 0);
  if (!with_uv) return {sphere.centre + sphere.radius * n, n, Frame(n).tangent, Vec2f(0)};
  const Vec3d around(n.z, 0, -n.x);  // d position / d phi with phi from +x towards -z
  const Vec3d tangent = length_squared(around) > 0 ? normalize(around) : Vec3d(1, 0, 0);
  const Vec2f uv(turn(-n.z, n.x), std::acos(glm::clamp(n.y, -1.0, 1.0)) / pi);
  return {sphere.centre + sphere.radius * n, n, tangent, uv};
}

ShapePoint point_on(const Plane& plane, const Vec3d& near, bool) {
  const Frame frame(plane.normal);
  const Vec3d position = near - dot(near - plane.point, plane.normal) * plane.normal;
  const Vec3d offset = position - plane.point;
  return {position, plane.normal, frame.tangent, Vec2f(dot(offset, frame.tangent), dot(offset, frame.bitangent))};
}

ShapePoint point_on(const Disk& disk, const Vec3d& near, bool with_uv) {
  ShapePoint p = point_on(Plane{disk.centre, disk.normal}, near, with_uv);
  p.uv = 0.5F + p.uv / static_cast<float>(2 * disk.radius);
  return p;
}

ShapePoint point_on(const Cylinder& cylinder, const Vec3d& near, bool with_uv) {
  const Vec3d axis = cylinder.top - cylinder.base;
  const double along = dot(near - cylinder.base, axis) / dot(axis, axis);
  const Vec3d foot = cylinder.base + along * axis;
  const Frame frame(normalize(axis));
  const Vec3d offset = near - foot;
  const Vec3d n = length_squared(offset) > 0 ? normalize(offset) : frame.tangent;
  const Vec3d tangent = cross(frame.normal, n);
  const Vec2f uv = with_uv ? Vec2f(turn(dot(n, frame.bitangent), dot(n, frame.tangent)), along) : Vec2f(0);
  return {foot + cylinder.radius * n, n, tangent, uv};
}

}  // namespace

ShapePoint shape_point(const Shape& shape, const Vec3d& near, bool with_uv) {
  return std::visit([&](const auto& s) { return point_on(s, near, with_uv); }, shape);
}

Vec3d shape_normal(const Shape& shape, const Vec3d& near) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return near - sphere->centre;
  if (const auto* disk = std::get_if<Disk>(&shape)) return disk->normal;
  if (const auto* plane = std::get_if<Plane>(&shape)) return plane->normal;
  const auto& cylinder = std::get<Cylinder>(shape);
  const Vec3d axis = cylinder.top - cylinder.base;
  const Vec3d offset = near - cylinder.base;
  return offset - dot(offset, axis) / dot(axis, axis) * axis;
}

SurfaceChange shape_change(const Shape& shape, const Vec3d& from, const Vec3d& step) {
  // By a difference: flat shapes have none of second order, round ones are stepped over by a small part of their size.
  double share = 1;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) share = 1e-3 * sphere->radius;
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) share = 1e-3 * cylinder->radius;
  const bool is_round = std::holds_alternative<Sphere>(shape) || std::holds_alternative<Cylinder>(shape);
  const double size = length(step);
  if (!(size > 0) || !std::isfinite(size)) return {};
  if (is_round) share = std::min(1.0, share / size);
  const Vec3d to = from + share * step;
  Vec2d uv = Vec2d(shape_point(shape, to).uv) - Vec2d(shape_point(shape, from).uv);
  if (is_round) uv.x -= std::round(uv.x);  // across the seam
  const Vec3d normal = normalize(shape_normal(shape, to)) - normalize(shape_normal(shape, from));
  return {.uv = {uv / share, uv / share}, .normal = normal / share};
}

Bounds shape_bounds(const Shape& shape, double horizon) {
  Bounds b;
  // A disk of radius r and normal n reaches r sqrt(1 - n_k^2) along axis k.
  const auto grow_disk = [&](const Vec3d& centre, const Vec3d& n, double r) {
    const Vec3d reach = r * glm::sqrt(glm::max(Vec3d(0), Vec3d(1) - n * n));
    b.grow(centre - reach);
    b.grow(centre + reach);
  };
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    b.grow(sphere->centre - Vec3d(sphere->radius));
    b.grow(sphere->centre + Vec3d(sphere->radius));
  } else if (const auto* disk = std::get_if<Disk>(&shape)) {
    grow_disk(disk->centre, disk->normal, disk->radius);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    const Vec3d n = normalize(cylinder->top - cylinder->base);
    grow_disk(cylinder->base, n, cylinder->radius);
    grow_disk(cylinder->top, n, cylinder->radius);
  } else {
    const auto& plane = std::get<Plane>(shape);
    grow_disk(plane.point, plane.normal, horizon);
  }
  return b;
}

}  // namespace penumbra
