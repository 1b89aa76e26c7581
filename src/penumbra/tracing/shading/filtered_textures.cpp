#include "penumbra/tracing/shading/filtered_textures.h"

namespace penumbra {
namespace {

/// Every texture of a material, and how its texels are meant.
struct Use {
  const std::optional<TextureRef>& ref;
  TexelEncoding encoding;
};

std::array<Use, 7> uses_of(const Material& m) {
  return {{{m.base_colour_texture, TexelEncoding::srgb},
           {m.metallic_roughness_texture, TexelEncoding::linear},
           {m.normal_texture, TexelEncoding::linear},
           {m.emission_texture, TexelEncoding::srgb},
           {m.transmission_texture, TexelEncoding::linear},
           {m.specular_texture, TexelEncoding::linear},
           {m.specular_colour_texture, TexelEncoding::srgb}}};
}

}  // namespace

FilteredTextures::FilteredTextures(const RayTracer& tracer) : tracer_(&tracer) {
  const Scene& scene = tracer.scene();
  pyramids_.resize(scene.images.size());
  for (const Material& material : scene.materials) {
    bool has_texture = false;
    for (const auto& [ref, encoding] : uses_of(material)) {
      if (!ref) continue;
      has_texture = true;
      const Texture& texture = scene.textures[ref->texture];
      const TextureImage& image = scene.images[texture.image];
      auto& pyramid = pyramids_[texture.image][static_cast<std::size_t>(encoding)];
      if (texture.mipmaps && has_texels(image) && !pyramid) pyramid.emplace(image, encoding);
    }
    filtered_.push_back(has_texture ? 1 : 0);
    any_ = any_ || has_texture || material.checker_colour;
  }
}

FilteredTextures::View::View(const FilteredTextures& textures, const SurfacePoint& point, const Footprint& footprint)
    : textures_(&textures), point_(&point), footprint_(&footprint) {
  if (!textures.is_filtered(point.material)) return;
  const SurfaceChange x = textures.tracer_->surface_change(point, footprint.x);
  const SurfaceChange y = textures.tracer_->surface_change(point, footprint.y);
  for (int set = 0; set < 2; ++set) uv_[set] = {x.uv[set], y.uv[set]};
}

Vec4f FilteredTextures::View::value(const TextureRef& ref, TexelEncoding encoding) const {
  const Scene& scene = textures_->tracer_->scene();
  const Texture& texture = scene.textures[ref.texture];
  const auto& pyramid = textures_->pyramids_[texture.image][static_cast<std::size_t>(encoding)];
  if (!pyramid) return texture_value(scene, ref, point_->uv, encoding);
  const std::size_t set = ref.uv_set == 1 ? 1 : 0;
  const Mat3d transform(ref.transform);
  const auto moved = [&](const Vec2d& step) { return Vec2d(transform * Vec3d(step, 0)); };
  const Vec2d uv(transform * Vec3d(Vec2d(point_->uv[set]), 1));
  return pyramid->value(texture, uv, {moved(uv_[set].x), moved(uv_[set].y)});
}

}  // namespace penumbra
