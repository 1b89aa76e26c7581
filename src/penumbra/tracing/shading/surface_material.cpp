#include "penumbra/tracing/shading/surface_material.h"

#include <algorithm>
#include <cmath>

#include "penumbra/scene/texture_lookup.h"
#include "penumbra/tracing/shading/checker.h"

namespace penumbra {
namespace {

/// The textures of one point, read there or averaged around it.
class TextureReader {
 public:
  TextureReader(const Scene& scene, const SurfacePoint& point, const FilteredTextures::View* filtered)
      : scene_(scene), point_(point), filtered_(filtered) {}

  [[nodiscard]] Vec4f operator()(const TextureRef& ref, TexelEncoding encoding) const {
    return filtered_ != nullptr ? filtered_->value(ref, encoding) : texture_value(scene_, ref, point_.uv, encoding);
  }
  [[nodiscard]] float second_colour(double size) const {
    return filtered_ != nullptr ? second_colour_share(point_, size, filtered_->footprint())
                                : second_colour_share(point_, size);
  }

 private:
  const Scene& scene_;
  const SurfacePoint& point_;
  const FilteredTextures::View* filtered_;
};

/// Base colour, 0..1, in rgb and opacity in w.
Vec4f base_colour(const Material& material, const SurfacePoint& point, const TextureReader& read) {
  Rgb colour = material.base_colour;
  if (material.checker_colour) {
    colour = glm::mix(colour, *material.checker_colour, read.second_colour(static_cast<double>(material.checker_size)));
  }
  Vec4f base = Vec4f(colour, material.alpha) * point.colour;
  if (material.base_colour_texture) {
    base *= read(*material.base_colour_texture, TexelEncoding::srgb);
  }
  return glm::clamp(base, 0.0F, 1.0F);
}

/// The shading normal bent by the normal map; kept on the front of the geometry.
Vec3d mapped_normal(const Material& material, const SurfacePoint& point, const TextureReader& read) {
  if (!material.normal_texture) return point.shading_normal;
  const Vec4f texel = read(*material.normal_texture, TexelEncoding::linear);
  const Vec3d bent =
      Vec3d(2.0F * Vec3f(texel) - Vec3f(1.0F)) * Vec3d(material.normal_scale, material.normal_scale, 1.0);
  const Vec3d world = bent.x * point.tangent + bent.y * point.bitangent + bent.z * point.shading_normal;
  if (!(glm::dot(world, point.geometric_normal) > 1e-6 * glm::length(world))) return point.shading_normal;
  return glm::normalize(world);
}

/// The roughness-metal, transmission and specular textures times their factors.
void read_factors(const Material& material, const TextureReader& read, SurfaceMaterial& surface) {
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

SurfaceMaterial surface_material(const Scene& scene, const SurfacePoint& point,
                                 const FilteredTextures::View* filtered) {
  const Material& material = scene.materials[point.material];
  const TextureReader read(scene, point, filtered);
  const Vec4f base = base_colour(material, point, read);
  SurfaceMaterial surface = surface_material(material);
  surface.base_colour = Rgb(base);
  surface.alpha = material.alpha_mode == AlphaMode::blend ? base.w : 1.0F;
  read_factors(material, read, surface);
  if (material.unlit) make_unlit(surface);
  surface.shading = Frame(mapped_normal(material, point, read));
  return surface;
}

Rgb spectrum_in(const EmissionSpectrum& spectrum, const Bands& bands) {
  Rgb light(0);
  for (int k = 0; k < 3; ++k) light[k] = static_cast<float>(spectrum.at(bands.wavelengths()[k]));
  return light;
}

SurfaceMaterial surface_material(const Scene& scene, const SurfacePoint& point, const Bands& bands,
                                 const FilteredTextures::View* filtered) {
  SurfaceMaterial surface = surface_material(scene, point, filtered);
  if (!bands.spectral()) return surface;
  const Material& material = scene.materials[point.material];
  surface.base_colour = bands.reflectance(surface.base_colour);
  surface.specular_colour = bands.reflectance(surface.specular_colour);
  surface.mirror = bands.reflectance(surface.mirror);
  if (surface.conductor) {
    surface.conductor->eta = bands.reflectance(surface.conductor->eta);
    surface.conductor->k = bands.reflectance(surface.conductor->k);
  }
  surface.emission =
      material.emission_spectrum ? spectrum_in(*material.emission_spectrum, bands) : bands.emission(surface.emission);
  if (disperses(material)) {
    surface.ior = static_cast<float>(refractive_index(*material.dispersion, bands.wavelengths()[0]));
  }
  if (!material.fluorescence) return surface;
  for (int k = 0; k < 3; ++k) {
    const double wavelength = bands.wavelengths()[k];
    if (band_of(material.fluorescence->edges, wavelength) == material.fluorescence->bands()) continue;
    surface.base_colour[k] = static_cast<float>(material.fluorescence->reflectance(wavelength));
  }
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
