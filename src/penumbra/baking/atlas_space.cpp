#include "penumbra/baking/atlas_space.h"

#include "penumbra/math/transform.h"

namespace penumbra {

AtlasSpace::AtlasSpace(const TexelMap& map, const RayTracer& tracer)
    : map_(map), tracer_(tracer), plane_(std::make_unique<Scene>()) {
  Mesh& mesh = plane_->meshes.emplace_back();
  const LightmapAtlas& atlas = map.atlas();
  for (std::uint32_t t = 0; t < atlas.first_triangle.back(); ++t) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int c = 0; c < 3; ++c) mesh.positions.emplace_back(map.corner(t, c), 0);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  plane_->materials.emplace_back();
  plane_->instances.push_back({"atlas", 0, Mat4d(1)});
  plane_tracer_ = std::make_unique<RayTracer>(*plane_);
}

std::optional<SurfacePoint> AtlasSpace::at(const Vec2d& place, std::uint32_t chart) const {
  Ray ray;
  ray.origin = Vec3d(place, 1);
  ray.direction = Vec3d(0, 0, -1);
  ray.t_max = 2;
  const auto hit = plane_tracer_->nearest(ray);
  if (!hit || map_.atlas().chart_of_triangle[hit->primitive] != chart) return std::nullopt;
  Hit on_surface;
  on_surface.object = map_.instance(hit->primitive);
  on_surface.primitive = hit->primitive - map_.atlas().first_triangle[on_surface.object];
  on_surface.barycentric = hit->barycentric;
  return tracer_.surface_point(ray, on_surface);
}

SurfacePoint AtlasSpace::at(std::uint32_t texel) const {
  const Texels& texels = map_.texels();
  const std::uint32_t triangle = texels.triangles[texel], i = map_.instance(triangle);
  const Instance& placed = map_.atlas().scene.instances[i];
  const Mesh& mesh = map_.atlas().scene.meshes[placed.mesh];
  Hit hit;
  hit.object = i;
  hit.primitive = triangle - map_.atlas().first_triangle[i];
  const auto& v = mesh.triangles[hit.primitive];
  const Vec3d a = transform_point(placed.to_world, mesh.positions[v[0]]);
  const Vec3d e1 = transform_point(placed.to_world, mesh.positions[v[1]]) - a;
  const Vec3d e2 = transform_point(placed.to_world, mesh.positions[v[2]]) - a;
  const Vec3d n = cross(e1, e2), p = texels.positions[texel] - a;
  const double size = dot(n, n);
  if (size > 0) hit.barycentric = {dot(cross(p, e2), n) / size, dot(cross(e1, p), n) / size};
  return tracer_.surface_point({}, hit);
}

Vec2d AtlasSpace::middle(std::uint32_t texel) const {
  const Texels& texels = map_.texels();
  const auto w = static_cast<std::uint32_t>(texels.width);
  return {texels.pixels[texel] % w + 0.5, texels.pixels[texel] / w + 0.5};
}

}  // namespace penumbra
