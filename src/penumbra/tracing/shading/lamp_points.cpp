#include "penumbra/tracing/shading/lamp_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/math/sampling.h"
#include "penumbra/tracing/opacity.h"
#include "penumbra/tracing/shading/surface_material.h"
#include "penumbra/tracing/shape_intersection.h"

namespace penumbra {

using std::numbers::pi;

WorldTriangle world_triangle(const Instance& instance, const Mesh& mesh, std::uint32_t triangle) {
  const Mesh::Triangle& c = mesh.triangles[triangle];
  const Vec3d v0 = transform_point(instance.to_world, mesh.positions[c[0]]);
  return {v0, transform_point(instance.to_world, mesh.positions[c[1]]) - v0,
          transform_point(instance.to_world, mesh.positions[c[2]]) - v0};
}

double shape_area(const Shape& shape) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return 4 * pi * s->radius * s->radius;
  if (const auto* d = std::get_if<Disk>(&shape)) return pi * d->radius * d->radius;
  if (const auto* c = std::get_if<Cylinder>(&shape)) return 2 * pi * c->radius * length(c->top - c->base);
  return 0;
}

LampPoint point_on_triangle(const Scene& scene, std::uint32_t object, std::uint32_t triangle, const Vec2d& u) {
  const Instance& instance = scene.instances[object];
  const Mesh& mesh = scene.meshes[instance.mesh];
  const WorldTriangle t = world_triangle(instance, mesh, triangle);
  const Vec2d b = sample_triangle(u);
  const Vec3d normal = t.area_normal() * (is_mirroring(instance.to_world) ? -1.0 : 1.0);
  const double area = length(normal);

  SurfacePoint p;
  p.position = t.v0 + b.x * t.e1 + b.y * t.e2;
  p.error = rounding_error(largest_component(p.position) + std::max(length(t.e1), length(t.e2)));
  p.geometric_normal = p.shading_normal = normal / area;
  p.object = object;
  p.primitive = triangle;
  p.material = mesh.material_of(triangle);
  const Mesh::Triangle& c = mesh.triangles[triangle];
  const auto blend = [&](const auto& values) {
    return static_cast<float>(1 - b.x - b.y) * values[c[0]] + static_cast<float>(b.x) * values[c[1]] +
           static_cast<float>(b.y) * values[c[2]];
  };
  for (int set = 0; set < 2; ++set) {
    if (!mesh.uv[set].empty()) p.uv[set] = blend(mesh.uv[set]);
  }
  if (!mesh.colours.empty()) p.colour = blend(mesh.colours);
  return {p, 1 / area};
}

std::optional<LampPoint> point_on_shape(const Scene& scene, std::uint32_t object, const Vec2d& u) {
  const ShapeObject& o = scene.shapes[object - scene.instances.size()];
  SurfacePoint p;
  p.object = object;
  p.material = o.material;
  double size = 0;
  if (const auto* sphere = std::get_if<Sphere>(&o.shape)) {
    p.geometric_normal = sample_sphere(u);
    p.position = sphere->centre + sphere->radius * p.geometric_normal;
    size = sphere->radius;
  } else if (const auto* disk = std::get_if<Disk>(&o.shape)) {
    const Frame frame(disk->normal);
    const Vec2d d = disk->radius * sample_disk(u);
    p.geometric_normal = disk->normal;
    p.position = disk->centre + d.x * frame.tangent + d.y * frame.bitangent;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&o.shape)) {
    const Vec3d axis = cylinder->top - cylinder->base;
    const Frame frame(normalize(axis));
    p.geometric_normal = std::cos(2 * pi * u.y) * frame.tangent + std::sin(2 * pi * u.y) * frame.bitangent;
    p.position = cylinder->base + u.x * axis + cylinder->radius * p.geometric_normal;
  } else {
    return std::nullopt;
  }
  p.shading_normal = p.geometric_normal;
  p.error = rounding_error(largest_component(p.position) + size);
  p.uv[0] = p.uv[1] = shape_point(o.shape, p.position).uv;
  return LampPoint{p, 1 / shape_area(o.shape)};
}

Rgb emission_at(const Scene& scene, const SurfacePoint& light) {
  const Material& m = scene.materials[light.material];
  Rgb emission = m.emission;
  if (m.emission_texture) emission = surface_material(scene, light).emission;
  if (m.alpha_mode == AlphaMode::opaque) return emission;
  const float alpha = surface_alpha(scene, m, light.uv, light.colour.w);
  if (m.alpha_mode == AlphaMode::blend) return alpha * emission;
  return alpha >= m.alpha_cutoff ? emission : Rgb(0);
}

}  // namespace penumbra
