#include "penumbra/baking/texel_paint.h"

#include <numbers>

#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {
namespace {

constexpr int samples_across = 4;  // where the material varies

bool varies(const Scene& scene, std::uint32_t instance, const Material& m) {
  return m.base_colour_texture || m.emission_texture || m.metallic_roughness_texture || m.transmission_texture ||
         m.checker_colour || !scene.meshes[scene.instances[instance].mesh].colours.empty();
}

void add(const Scene& scene, const SurfacePoint& point, TexelPaint& sum) {
  SurfaceMaterial m = surface_material(scene, point);
  if (scene.materials[point.material].unlit) {  // a picture of light, neither lamp nor mirror
    sum.matt += 1;
    return;
  }
  sum.matt += (1 - m.metallic) * (1 - m.transmission) * (1 - max_component(m.mirror)) * m.alpha;
  const Rgb emission = std::numbers::pi_v<float> * m.emission;
  sum.emission += emission;
  if (scene.materials[point.material].double_sided) sum.back_emission += emission;
  m.specular = 0;  // the layer over the base is left out
  sum.albedo += Bsdf(m, m.shading, point.geometric_normal).diffuse_reflectance();
}

}  // namespace

TexelPaint paint_of_texel(const TexelMap& map, const AtlasSpace& space, const StraightLamps& lamps,
                          std::uint32_t texel) {
  const Scene& scene = map.atlas().scene;
  const std::uint32_t triangle = map.texels().triangles[texel];
  const std::uint32_t instance = map.instance(triangle);
  TexelPaint paint;
  int count = 0;
  if (varies(scene, instance, scene.materials[map.material(triangle)])) {
    for (int k = 0; k < samples_across * samples_across; ++k) {
      const Vec2d offset((k % samples_across + 0.5) / samples_across - 0.5,
                         (k / samples_across + 0.5) / samples_across - 0.5);
      const auto point = space.at(space.middle(texel) + offset, map.chart(texel));
      if (!point) continue;
      add(scene, *point, paint);
      ++count;
    }
  }
  if (count == 0) {
    add(scene, space.at(texel), paint);
    count = 1;
  }
  const float share = 1 / static_cast<float>(count);
  paint.albedo *= share;
  paint.matt *= share;
  paint.emission *= lamps.holds(triangle, false) ? 0 : share;
  paint.back_emission *= lamps.holds(triangle, true) ? 0 : share;
  return paint;
}

}  // namespace penumbra
