#include "penumbra/io/mtl_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/image/image_io.h"
#include "penumbra/io/text_cursor.h"

namespace penumbra {
namespace {

/// How MTL's illumination models and values part into ours.
enum class Surface { lambert, glossy, mirror, glass };

Surface surface_of(const MtlMaterial& mtl) {
  const int illum = mtl.illum.value_or(2);
  const bool clear = mtl.opacity.value_or(1) < 1 && mtl.ior.has_value();
  if (illum == 4 || illum == 6 || illum == 7 || illum == 9 || clear) return Surface::glass;
  const bool shiny = !is_black(mtl.specular.value_or(Rgb(0)));
  if (!shiny || illum < 2) return Surface::lambert;
  return illum == 3 || illum == 5 ? Surface::mirror : Surface::glossy;
}

void make_glossy(Material& material, const Rgb& specular, float shininess) {
  constexpr float plain_f0 = 0.04F;  // of ior 1.5
  material.specular = 1;
  material.ior = 1.5F;
  material.specular_colour = specular / plain_f0;
  const float alpha = std::sqrt(2 / (shininess + 2));
  material.roughness = std::sqrt(alpha);
}

void make_glass(Material& material, const MtlMaterial& mtl) {
  const float opacity = mtl.opacity.value_or(1);
  material.specular = 1;
  material.roughness = 0;
  material.ior = std::max(1.0F, mtl.ior.value_or(1.5F));
  material.transmission = opacity < 1 ? 1 - opacity : 1;
  const bool some_stays_diffuse = material.transmission < 1 && mtl.diffuse && !is_black(*mtl.diffuse);
  if (!some_stays_diffuse) material.base_colour = Rgb(1);
  if (mtl.filter) material.base_colour = *mtl.filter;
}

}  // namespace

Material default_obj_material() {
  Material material;
  material.name = "default";
  material.specular = 0;
  return material;
}

Material MtlMaterials::material(std::string_view name, const MtlMaterial& mtl) {
  Material out;
  out.name = name;
  out.specular = 0;
  out.base_colour = reflectance(mtl.diffuse.value_or(mtl.diffuse_map ? Rgb(1) : Rgb(0.8F)), mtl);
  out.emission = mtl.emission.value_or(mtl.emission_map ? Rgb(1) : Rgb(0));
  const Rgb specular = reflectance(mtl.specular.value_or(Rgb(0)), mtl);
  switch (surface_of(mtl)) {
    case Surface::lambert:
      break;
    case Surface::glossy:
      make_glossy(out, specular, mtl.shininess.value_or(0));
      break;
    case Surface::mirror:
      out.mirror = specular;
      break;
    case Surface::glass:
      make_glass(out, mtl);
      out.base_colour = reflectance(out.base_colour, mtl);
      break;
  }
  if (out.transmission == 0 && mtl.opacity.value_or(1) < 1) {
    out.alpha = *mtl.opacity;
    out.alpha_mode = AlphaMode::blend;
  }
  set_textures(out, mtl);
  return out;
}

Rgb MtlMaterials::reflectance(const Rgb& colour, const MtlMaterial& mtl) {
  const Rgb clamped = glm::min(colour, Rgb(1));
  if (clamped != colour) {
    warnings_.count("reflectances above 1 were cut to 1", fmt::format("{} of {}", mtl.place, mtl.file));
  }
  return clamped;
}

void MtlMaterials::set_textures(Material& material, const MtlMaterial& mtl) {
  if (mtl.diffuse_map) {
    material.base_colour_texture = texture(*mtl.diffuse_map, mtl);
    if (material.base_colour_texture && is_black(material.base_colour)) {
      warnings_.count("Kd 0 would blacken map_Kd, so the map is shown as it is",
                      fmt::format("{} of {}", mtl.diffuse_map->place, mtl.file));
      material.base_colour = Rgb(1);
    }
  }
  if (mtl.emission_map) {
    material.emission_texture = texture(*mtl.emission_map, mtl);
    if (!material.emission_texture && !mtl.emission) material.emission = Rgb(0);
  }
  if (!mtl.opacity_map) return;
  // Holes come from the alpha of map_Kd itself; a picture of their own is not kept.
  if (material.base_colour_texture && mtl.diffuse_map->file == mtl.opacity_map->file) {
    material.alpha_mode = AlphaMode::mask;
  } else {
    warnings_.count("map_d is heeded only where it names the same file as map_Kd",
                    fmt::format("{} of {}", mtl.opacity_map->place, mtl.file));
  }
}

std::optional<TextureRef> MtlMaterials::texture(const MtlMap& map, const MtlMaterial& mtl) {
  const auto image_index = image(map, mtl);
  if (!image_index) return std::nullopt;
  const auto [found, is_new] =
      texture_of_image_.emplace(std::pair(*image_index, map.clamp), static_cast<std::uint32_t>(scene_.textures.size()));
  if (is_new) {
    Texture made;
    made.image = *image_index;
    made.wrap_u = made.wrap_v = map.clamp ? Wrap::clamp : Wrap::repeat;
    scene_.textures.push_back(made);
  }
  TextureRef ref;
  ref.texture = found->second;
  // (u, v) -> offset + scale (u, v) with v upwards, said of v downwards.
  const Vec2f scale(map.scale);
  const Vec2f offset(map.offset);
  ref.transform = Mat3f(scale.x, 0, 0, 0, scale.y, 0, offset.x, 1 - scale.y - offset.y, 1);
  return ref;
}

std::optional<std::uint32_t> MtlMaterials::image(const MtlMap& map, const MtlMaterial& mtl) {
  const auto [slot, is_new] = image_of_file_.try_emplace(map.file);
  if (!is_new) return slot->second;
  const std::string place = fmt::format("{} of {}", map.place, mtl.file);
  try {
    const auto path = folder_.resolve(map.file);
    Image8 decoded = decode_image8(read_file(path), path.string());
    slot->second = static_cast<std::uint32_t>(scene_.images.size());
    scene_.images.push_back({.name = map.file,
                             .width = decoded.width,
                             .height = decoded.height,
                             .channels = decoded.channels,
                             .texels = std::move(decoded.data)});
  } catch (const std::invalid_argument& wrong) {
    warnings_.count(fmt::format("a picture is not read, so colours stand for it: it {}", wrong.what()),
                    fmt::format("{} ({})", place, in_quotes(map.file)));
  } catch (const FileError& error) {
    warnings_.count("a picture could not be read, so colours stand for it", fmt::format("{}: {}", place, error.what()));
  }
  return slot->second;
}

}  // namespace penumbra
