#include "penumbra/radiosity/meshing/vertex_coloured_scene.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>
#include <vector>

#include "penumbra/radiosity/meshing/shading_mesh.h"
#include "penumbra/radiosity/meshing/sharp_irradiance.h"
#include "penumbra/scene/object_label.h"

namespace penumbra {
namespace {

/// Reflectance and emission of an element: what makes its vertices different from its neighbours'.
using Paint = std::array<double, 6>;

Paint paint_of(const PatchMesh& elements, std::size_t element) {
  Paint paint;
  for (std::size_t b = 0; b < 3; ++b) {
    paint[b] = elements.reflectance[3 * element + b];
    paint[3 + b] = elements.emission[3 * element + b];
  }
  return paint;
}

/// An object's mesh as it grows.
struct Growing {
  Mesh mesh;
  std::map<std::pair<std::uint32_t, Paint>, std::uint32_t> vertex_of;
};

SharpIrradiance light_at_vertices(const PatchMesh& elements, std::span<const double> irradiance,
                                  const LampIrradiance* lamps) {
  ShadingMesh shading = make_shading_mesh(elements);
  if (lamps != nullptr) return sharp_irradiance(*lamps, elements, shading, irradiance);
  std::vector<double> blended = shading.at_vertices(irradiance, 3);
  return {std::move(shading), std::move(blended)};
}

}  // namespace

Scene vertex_coloured_scene(const PatchMesh& elements, std::span<const double> irradiance, double scale,
                            const Scene& scene, const LampIrradiance* lamps) {
  const SharpIrradiance lit = light_at_vertices(elements, irradiance, lamps);
  const ShadingMesh& shading = lit.mesh;
  const std::vector<double>& light = lit.at_vertices;
  std::map<std::uint32_t, Growing> objects;
  for (std::size_t t = 0; t < shading.triangles.size(); ++t) {
    const std::uint32_t element = shading.element_of_triangle[t];
    const PatchSurface& surface = elements.surfaces[element];
    if (surface.back) continue;
    Growing& object = objects[surface.object];
    const Paint paint = paint_of(elements, element);
    Mesh::Triangle corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = shading.triangles[t][k];
      const auto [found, fresh] =
          object.vertex_of.try_emplace({v, paint}, static_cast<std::uint32_t>(object.mesh.positions.size()));
      corners[k] = found->second;
      if (!fresh) continue;
      object.mesh.positions.push_back(shading.positions[v]);
      Vec4f colour(0, 0, 0, 1);
      for (std::size_t b = 0; b < 3; ++b) {
        const double radiosity = paint[3 + b] + paint[b] * std::max(0.0, light[3 * v + b]);
        colour[static_cast<int>(b)] = static_cast<float>(std::clamp(scale * radiosity, 0.0, 1.0));
      }
      object.mesh.colours.push_back(colour);
    }
    object.mesh.triangles.push_back(corners);
  }

  Scene coloured;
  coloured.extras = scene.extras;
  Material material;
  material.name = "baked";
  material.base_colour = Rgb(1.0F);
  material.unlit = true;
  material.double_sided = true;
  coloured.materials.push_back(material);
  for (auto& [number, object] : objects) {
    Instance instance{.name = object_label(scene, number),
                      .mesh = static_cast<std::uint32_t>(coloured.meshes.size()),
                      .to_world = Mat4d(1.0)};
    object.mesh.name = instance.name;
    if (number < scene.instances.size()) {
      instance.extras = scene.instances[number].extras;
      object.mesh.extras = scene.meshes[scene.instances[number].mesh].extras;
    }
    coloured.instances.push_back(std::move(instance));
    coloured.meshes.push_back(std::move(object.mesh));
  }
  return coloured;
}

}  // namespace penumbra
