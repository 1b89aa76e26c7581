#include "penumbra/tracing/shading/surface_material.h"

#include <algorithm>
#include <cmath>

#include "penumbra/scene/texture_lookup.h"

namespace penumbra {
namespace {

/// The squares of a chequered floor lie in the plane of the two axes nearest to the surface's.
bool on_second_colour(const SurfacePoint& point, double size) {
  const Vec3d n = glm::abs(point.geometric_normal);
  const int across = n.x > n.y && n.x > n.z ? 0 : (n.y >= n.z ? 1 : 2);
  const double a = std::floor(point.position[(across + 1) % 3] / size);
  const double b = std::floor(point.position[(across + 2) % 3] / size);
  return std::fmod(std::abs(a + b), 2.0) == 1.0;
}

/// Base colour, 0..1, in rgb and opacity in w.
Vec4f base_colour(const Scene& scene, const Material& material, const SurfacePoint& point) {
  Rgb colour = material.base_colour;
  if (material.checker_colour && on_second_colour(point, material.checker_size)) colour = *material.checker_colour;
  Vec4f base = Vec4f(colour, material.alpha) * point.colour;
  if (material.base_colour_texture) {
    base *= texture_value(scene, *material.base_colour_texture, point.uv, TexelEncoding::srgb);
  }
  return glm::clamp(base, 0.0F, 1.0F);
}

/// The shading normal bent by the normal map; kept on the front of the geometry.
Vec3d mapped_normal(const Scene& scene, const Material& material, const SurfacePoint& point) {
  if (!material.normal_texture) return point.shading_normal;
  const Vec4f texel = texture_value(scene, *material.normal_texture, point.uv, TexelEncoding::linear);
  const Vec3d bent =
      Vec3d(2.0F * Vec3f(texel) - Vec3f(1.0F)) * Vec3d(material.normal_scale, material.normal_scale, 1.0);
  const Vec3d world = bent.x * point.tangent + bent.y * point.bitangent + bent.z * point.shading_normal;
  if (!(glm::dot(world, point.geometric_normal) > 1e-6 * glm::length(world))) return point.shading_normal;
  return glm::normalize(world);
}

/// The roughness-metal, transmission and specular textures times their factors.
void read_factors(const Scene& scene, const Material& material, const SurfacePoint& point, SurfaceMaterial& surface) {
  const auto read = [&](const TextureRef& ref, TexelEncoding encoding) {
    return texture_value(scene, ref, point.uv, encoding);
  };
  if (material.metallic_roughness_texture) {
    const Vec4f texel = read(*material.metallic_roughness_texture, TexelEncoding::linear);
    surface.roughness *= texel.y;
    surface.metallic *= texel.z;
  }
  if (material.transmission_texture) {
    surface.transmission *= read(*material.transmission_texture, TexelEncoding::linear).x;
  }
  if (material.specular_texture) surface.specular *= read(*material.specular_texture, TexelEncoding::linear).w;
  if (material.specular_colour_texture) {
    surface.specular_colour *= Rgb(read(*material.specular_colour_texture, TexelEncoding::srgb));
  }
  if (material.emission_texture) surface.emission *= Rgb(read(*material.emission_texture, TexelEncoding::srgb));
}

/// KHR_materials_unlit: the base colour shines, nothing reflects.
void make_unlit(SurfaceMaterial& surface) {
  surface.emission = surface.base_colour;
  surface.base_colour = Rgb(0);
  surface.metallic = surface.specular = surface.transmission = 0;
  surface.mirror = Rgb(0);
  surface.conductor.reset();
}

}  // namespace

SurfaceMaterial surface_material(const Material& material) {
  SurfaceMaterial surface;
  surface.base_colour = material.base_colour;
  surface.metallic = material.metallic;
  surface.roughness = material.roughness;
  surface.specular = material.specular;
  surface.specular_colour = material.specular_colour;
  surface.ior = material.ior;
  surface.transmission = material.transmission;
  surface.thin_walled = material.thin_walled;
  surface.mirror = material.mirror;
  surface.conductor = material.conductor;
  surface.emission = material.emission;
  return surface;
}

SurfaceMaterial surface_material(const Scene& scene, const SurfacePoint& point) {
  const Material& material = scene.materials[point.material];
  const Vec4f base = base_colour(scene, material, point);
  SurfaceMaterial surface = surface_material(material);
  surface.base_colour = Rgb(base);
  surface.alpha = material.alpha_mode == AlphaMode::blend ? base.w : 1.0F;
  read_factors(scene, material, point, surface);
  if (material.unlit) make_unlit(surface);
  surface.shading = Frame(mapped_normal(scene, material, point));
  return surface;
}

Frame frame_towards(const Frame& shading, const Vec3d& geometric_normal, const Vec3d& wo) {
  constexpr double least_cosine = 0.01;
  const double side = glm::dot(geometric_normal, wo);
  const Vec3d w = side < 0 ? -wo : wo;
  const double cosine = glm::dot(shading.normal, w);
  if (cosine >= std::min(least_cosine, std::abs(side))) return shading;
  // In the plane of the two, away from w by the cosine wanted; both are on the geometry's front, and so is what lies
  // between.
  const Vec3d across = shading.normal - cosine * w;
  const double length = glm::length(across);
  if (!(length > 1e-9)) return Frame(geometric_normal);
  return Frame(glm::normalize(least_cosine * w + std::sqrt(1 - least_cosine * least_cosine) / length * across));
}

}  // namespace penumbra
