#include "penumbra/scene/lit.h"

#include <algorithm>
#include <variant>
#include <vector>

#include "penumbra/scene/texture_lookup.h"

namespace penumbra {
namespace {

bool is_lamp(const Scene& scene, const Material& material) {
  if (material.emission_spectrum && !material.unlit) return true;  // though it may be seen by dyes alone
  if (!material.emits() || material.unlit) return false;
  if (!material.emission_texture) return true;
  const Texture& texture = scene.textures[material.emission_texture->texture];
  const Vec4f mean = mean_texel(scene.images[texture.image], TexelEncoding::srgb);
  return luminance(material.emission * Rgb(mean)) >= least_lamp_luminance;
}

}  // namespace

bool is_lit(const Scene& scene) {
  if (scene.environment) return true;
  const bool shone_upon = std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
    return !std::holds_alternative<AmbientLight>(light.kind);
  });
  if (shone_upon) return true;

  std::vector<char> used(scene.materials.size(), 0);  // by something that stands in the scene
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.triangles.empty()) continue;
    for (const std::uint32_t m : mesh.materials) used[m] = 1;
  }
  for (const ShapeObject& shape : scene.shapes) used[shape.material] = 1;
  for (std::size_t m = 0; m < used.size(); ++m) {
    if (used[m] != 0 && is_lamp(scene, scene.materials[m])) return true;
  }
  return false;
}

}  // namespace penumbra
