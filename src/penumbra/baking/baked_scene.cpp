#include "penumbra/baking/baked_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "penumbra/baking/dithering.h"

namespace penumbra {
namespace {

/// Appends a picture and a texture that reads it without leaving it.
std::uint32_t add_texture(Scene& scene, const Image& image, float scale) {
  scene.images.push_back({.name = "baked-light",
                          .width = image.width,
                          .height = image.height,
                          .channels = static_cast<int>(image.channels.size()),
                          .texels = dithered_srgb8(image, scale)});
  scene.textures.push_back({.image = static_cast<std::uint32_t>(scene.images.size() - 1),
                            .wrap_u = Wrap::clamp,
                            .wrap_v = Wrap::clamp,
                            .filter = TexelFilter::linear,
                            .mipmaps = false});
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

/// What is left of a material when its looks are replaced.
Material shell_of(const Material& m) {
  Material shell;
  shell.name = m.name;
  shell.extras = m.extras;
  shell.alpha_mode = m.alpha_mode;
  shell.alpha_cutoff = m.alpha_cutoff;
  shell.double_sided = m.double_sided;
  shell.metallic = 0;
  shell.roughness = 1;
  return shell;
}

/// The atlas's coordinates become the only ones, and what served the old materials goes.
void use_atlas_only(Scene& scene) {
  scene.images.clear();
  scene.textures.clear();
  for (Mesh& mesh : scene.meshes) {
    mesh.uv[0] = std::move(mesh.uv[1]);
    mesh.uv[1].clear();
    mesh.colours.clear();
    mesh.tangents.clear();
  }
}

void dress_unlit(Scene& scene, const AtlasLight& light, double exposure) {
  use_atlas_only(scene);
  const TextureRef atlas{.texture = add_texture(scene, light.image, static_cast<float>(std::exp2(exposure)))};
  for (Material& material : scene.materials) {
    material = shell_of(material);
    material.base_colour = Rgb(1.0F);
    material.unlit = true;
    material.base_colour_texture = atlas;
  }
}

/// The material that each chart's faces wear.
std::vector<std::uint32_t> materials_of_charts(const LightmapAtlas& atlas) {
  std::vector<std::uint32_t> materials(atlas.charts.size(), 0);
  for (std::size_t i = 0; i < atlas.scene.instances.size(); ++i) {
    const Mesh& mesh = atlas.scene.meshes[atlas.scene.instances[i].mesh];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      materials[atlas.chart_of_triangle[atlas.first_triangle[i] + t]] = mesh.material_of(t);
    }
  }
  return materials;
}

/// Divides each chart's light by the largest of its material, which is returned by material.
std::vector<float> normalise(const LightmapAtlas& atlas, AtlasLight& light) {
  const std::vector<std::uint32_t> material_of = materials_of_charts(atlas);
  std::vector<float> strength(atlas.scene.materials.size(), 0.0F);
  Image& image = light.image;
  const std::size_t channels = image.channels.size();
  const auto for_pixels = [&](const auto& visit) {
    for (std::size_t p = 0; p < light.map.charts.size(); ++p) {
      if (light.map.charts[p] != ChartMap::none)
        visit(image.data.data() + p * channels, material_of[light.map.charts[p]]);
    }
  };
  for_pixels([&](const float* pixel, std::uint32_t m) {
    strength[m] = std::max({strength[m], pixel[0], pixel[1], pixel[2]});
  });
  for_pixels([&](float* pixel, std::uint32_t m) {
    for (int b = 0; b < 3 && strength[m] > 0; ++b) pixel[b] /= strength[m];
  });
  return strength;
}

void dress_hdr(LightmapAtlas& atlas, AtlasLight& light, double exposure) {
  const std::vector<float> strength = normalise(atlas, light);
  Scene& scene = atlas.scene;
  use_atlas_only(scene);
  const TextureRef texture{.texture = add_texture(scene, light.image, 1)};
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    Material& material = scene.materials[m];
    material = shell_of(material);
    material.base_colour = Rgb(0.0F);
    material.specular = 0;
    material.emission = Rgb(strength[m] * static_cast<float>(std::exp2(exposure)));
    material.emission_texture = texture;
    if (material.alpha_mode != AlphaMode::opaque) material.base_colour_texture = texture;  // for its alpha
  }
}

float largest(const Image& image) { return image.data.empty() ? 0.0F : *std::ranges::max_element(image.data); }

std::map<std::string, std::string> notes_on(BakeProfile profile, double exposure, const LightmapAtlas& atlas) {
  std::map<std::string, std::string> notes{
      {"atlas", fmt::format("{} x {} texels", atlas.width, atlas.height)},
      {"texels_per_metre", fmt::format("{:.6g}", atlas.texels_per_metre)},
      {"charts", atlas.from_input ? "TEXCOORD_1 of the input" : fmt::format("{} made", atlas.charts.size())}};
  switch (profile) {
    case BakeProfile::unlit:
      notes["profile"] = "unlit";
      notes["quantity"] = "radiance in W/(m^2 sr)";
      notes["colour"] = "linear Rec. 709: radiance x 2^exposure_ev, cut at 1; stored as sRGB, dithered";
      break;
    case BakeProfile::hdr:
      notes["profile"] = "hdr";
      notes["quantity"] = "radiance in W/(m^2 sr)";
      notes["colour"] = "linear Rec. 709: emission (texture x factor x strength) = radiance x 2^exposure_ev";
      break;
    case BakeProfile::lightmap:
      notes["profile"] = "lightmap";
      notes["quantity"] = "irradiance in W/m^2, in TEXCOORD_1; radiance = emission + albedo x irradiance / pi";
      break;
  }
  if (profile != BakeProfile::lightmap) notes["exposure_ev"] = fmt::format("{}", exposure);
  return notes;
}

}  // namespace

BakedScene baked_scene(LightmapAtlas atlas, AtlasLight light, BakeProfile profile, double exposure) {
  BakedScene baked;
  baked.notes = notes_on(profile, exposure, atlas);
  atlas.scene.lights.clear();
  atlas.scene.environment.reset();
  switch (profile) {
    case BakeProfile::unlit:
      dress_unlit(atlas.scene, light, exposure);
      break;
    case BakeProfile::hdr:
      dress_hdr(atlas, light, exposure);
      break;
    case BakeProfile::lightmap:
      baked.lightmap_strength = std::max(largest(light.image), 1e-30F);
      baked.lightmap = add_texture(atlas.scene, light.image, 1 / baked.lightmap_strength);
      baked.notes["lightmap_strength"] = fmt::format("{:.9g}", baked.lightmap_strength);
      break;
  }
  baked.scene = std::move(atlas.scene);
  return baked;
}

}  // namespace penumbra
