#include "penumbra/tracing/opacity.h"

#include <algorithm>

#include "penumbra/scene/texture_lookup.h"

namespace penumbra {

float surface_alpha(const Scene& scene, const Material& material, const Vec2f (&uv)[2], float vertex_alpha) {
  float alpha = material.alpha * vertex_alpha;
  if (material.base_colour_texture) {
    alpha *= texture_value(scene, *material.base_colour_texture, uv, TexelEncoding::linear).w;
  }
  return std::clamp(alpha, 0.0F, 1.0F);
}

bool is_solid(const Scene& scene, const Mesh& mesh, std::uint32_t triangle, const Vec2d& barycentric) {
  const Material& material = scene.materials[mesh.material_of(triangle)];
  if (material.alpha_mode != AlphaMode::mask) return true;
  const Mesh::Triangle& corners = mesh.triangles[triangle];
  const auto b1 = static_cast<float>(barycentric.x);
  const auto b2 = static_cast<float>(barycentric.y);
  const float b0 = 1 - b1 - b2;
  Vec2f uv[2]{};
  for (int set = 0; set < 2; ++set) {
    const auto& values = mesh.uv[set];
    if (!values.empty()) uv[set] = b0 * values[corners[0]] + b1 * values[corners[1]] + b2 * values[corners[2]];
  }
  const auto& colours = mesh.colours;
  const float vertex_alpha =
      colours.empty() ? 1.0F : b0 * colours[corners[0]].w + b1 * colours[corners[1]].w + b2 * colours[corners[2]].w;
  return surface_alpha(scene, material, uv, vertex_alpha) >= material.alpha_cutoff;
}

}  // namespace penumbra
