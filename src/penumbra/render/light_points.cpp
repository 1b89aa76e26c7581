#include "penumbra/render/light_points.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

std::optional<PacketLight> punctual(const Light& light) {
  PacketLight out;
  if (const auto* far = std::get_if<DirectionalLight>(&light.kind)) {
    if (far->angular_radius > 0) return std::nullopt;
    out.kind = PacketLight::Kind::far;
    out.position = Vec3f(-far->direction);
    out.strength = far->irradiance;
    return out;
  }
  const auto* point = std::get_if<PointLight>(&light.kind);
  if (point == nullptr || point->web) return std::nullopt;
  out.kind = PacketLight::Kind::point;
  out.position = Vec3f(point->position);
  out.strength = point->intensity;
  out.range = std::isfinite(point->range) ? static_cast<float>(point->range) : 0.0F;
  out.inverse_square = point->inverse_square;
  return out;
}

std::optional<PacketLight> area(const Scene& scene, const LightSampler::Source& source) {
  const Instance& instance = scene.instances[source.index];
  const Mesh& mesh = scene.meshes[instance.mesh];
  const double mirror = is_mirroring(instance.to_world) ? -1.0 : 1.0;
  PacketLight out;
  // Lights of many parts are better met by choice, see DirectLight.
  if (source.triangles.size() > 4) return std::nullopt;
  for (std::size_t i = 0; i < source.triangles.size(); ++i) {
    const Mesh::Triangle& c = mesh.triangles[source.triangles[i]];
    const Material& material = scene.materials[mesh.material_of(source.triangles[i])];
    if (material.emission_texture || material.alpha_mode != AlphaMode::opaque) return std::nullopt;
    const Vec3d v0 = transform_point(instance.to_world, mesh.positions[c[0]]);
    const Vec3d e1 = transform_point(instance.to_world, mesh.positions[c[1]]) - v0;
    const Vec3d e2 = transform_point(instance.to_world, mesh.positions[c[2]]) - v0;
    const Vec3d normal = mirror * 0.5 * cross(e1, e2);
    const double chance = source.cdf[i + 1] - source.cdf[i];
    out.triangles.push_back({.v0 = Vec3f(v0),
                             .e1 = Vec3f(e1),
                             .e2 = Vec3f(e2),
                             .normal = Vec3f(normalize(normal)),
                             .inverse_density = static_cast<float>(length(normal) / chance),
                             .radiance = material.emission,
                             .both_sides = material.double_sided});
    out.cdf.push_back(static_cast<float>(source.cdf[i + 1]));
  }
  out.cdf.back() = 1;
  return out;
}

PacketLight middle_of(const LightSampler::Middle& middle) {
  PacketLight out;
  out.at_middle = true;
  out.triangles.push_back({.v0 = Vec3f(middle.position),
                           .e1 = Vec3f(0),
                           .e2 = Vec3f(0),
                           .normal = Vec3f(middle.normal),
                           .inverse_density = static_cast<float>(middle.area),
                           .radiance = middle.radiance,
                           .both_sides = middle.both_sides});
  out.cdf.push_back(1);
  return out;
}

}  // namespace

const PacketLight::Triangle& PacketLight::choose(float& u) const {
  const auto cell = static_cast<std::size_t>(std::upper_bound(cdf.begin(), cdf.end() - 1, u) - cdf.begin());
  const float below = cell == 0 ? 0 : cdf[cell - 1];
  u = std::clamp((u - below) / (cdf[cell] - below), 0.0F, 1.0F);
  return triangles[cell];
}

std::optional<std::vector<PacketLight>> packet_lights(const Scene& scene, const LightSampler& lights, bool at_middles) {
  std::vector<PacketLight> all;
  for (std::size_t i = 0; i < lights.light_count(); ++i) {
    const LightSampler::Source& source = lights.light(i);
    std::optional<PacketLight> light;
    if (at_middles && source.middle) {
      all.push_back(middle_of(*source.middle));
      continue;
    }
    if (source.kind == LightSampler::Kind::punctual) light = punctual(scene.lights[source.index]);
    if (source.kind == LightSampler::Kind::mesh) light = area(scene, source);
    if (!light) return std::nullopt;
    all.push_back(std::move(*light));
  }
  return all;
}

}  // namespace penumbra
