#include "penumbra/baking/metal_texels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/tracing/shading/bsdf.h"

namespace penumbra {
namespace {

constexpr std::array<Vec2d, 4> looks{Vec2d(-0.25, -0.25), {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}};
constexpr double largest_code = 32767;

double sign(double x) { return x < 0 ? -1 : 1; }

/// The sphere on a square, by way of an octahedron (Meyer et al. 2010).
Vec2d octahedral(const Vec3d& n) {
  const Vec3d p = n / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  return p.z >= 0 ? Vec2d(p.x, p.y) : Vec2d((1 - std::abs(p.y)) * sign(p.x), (1 - std::abs(p.x)) * sign(p.y));
}
Vec3d from_octahedral(const Vec2d& e) {
  const double z = 1 - std::abs(e.x) - std::abs(e.y);
  if (z >= 0) return normalize(Vec3d(e, z));
  return normalize(Vec3d((1 - std::abs(e.y)) * sign(e.x), (1 - std::abs(e.x)) * sign(e.y), z));
}

std::uint8_t byte_of(float share, int whole) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0F, 1.0F) * static_cast<float>(whole)));
}

}  // namespace

bool is_opaque_metal(const Material& m) {
  return !m.unlit && m.metallic > 0 && m.transmission == 0 && m.mirror == Rgb(0.0F) && m.alpha_mode != AlphaMode::blend;
}

MetalTexels::MetalTexels(const TexelMap& map, const AtlasSpace& space) {
  const Scene& scene = map.atlas().scene;
  if (std::ranges::none_of(scene.materials, is_opaque_metal)) return;
  texels_.assign(map.texels().count(), Metal{0, 0, {0, 0, 0}, 0, 0, whole});
  parallel_for(texels_.size(), 256, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) {
      const auto texel = static_cast<std::uint32_t>(t);
      const std::uint32_t material = map.material(map.texels().triangles[texel]);
      if (is_opaque_metal(scene.materials[material])) texels_[t] = mean_over(map, space, texel);
    }
  });
}

MetalTexels::Metal MetalTexels::mean_over(const TexelMap& map, const AtlasSpace& space, std::uint32_t texel) {
  Vec3d normal(0);
  Rgb colour(0);
  float metallic = 0, roughness = 0, diffuse = 0, count = 0;
  const auto add = [&](const SurfacePoint& p) {
    SurfaceMaterial m = surface_material(map.atlas().scene, p);
    m.specular = 0;  // the layer over the base is left out
    diffuse += std::max(max_component(Bsdf(m, m.shading, p.geometric_normal).diffuse_reflectance()),
                        is_black(m.emission) ? 0.0F : 0.5F);
    metallic += m.metallic, roughness += m.metallic * m.roughness, colour += m.metallic * m.base_colour;
    normal += m.shading.normal;
    count += 1;
  };
  for (const Vec2d& offset : looks) {
    if (const auto p = space.at(space.middle(texel) + offset, map.chart(texel))) add(*p);
  }
  if (count == 0 || normal == Vec3d(0)) add(space.at(texel));
  Metal metal{0, 0, {0, 0, 0}, 0, byte_of(metallic / count, whole), whole};
  if (metal.metallic == 0) return metal;
  const Vec2d square = octahedral(normalize(normal));
  metal.normal_u = static_cast<std::int16_t>(std::lround(largest_code * square.x));
  metal.normal_v = static_cast<std::int16_t>(std::lround(largest_code * square.y));
  for (int b = 0; b < 3; ++b) metal.root_colour[b] = byte_of(std::sqrt(colour[b] / metallic), whole);
  metal.roughness = byte_of(roughness / metallic, whole);
  metal.ending = byte_of(diffuse / (diffuse + metallic), whole);
  // Neither never nor always where both happen.
  if (diffuse > 0) metal.ending = std::clamp<std::uint8_t>(metal.ending, 1, whole - 1);
  return metal;
}

SurfaceMaterial MetalTexels::metal(std::uint32_t texel, const Material& material) const {
  const Metal& mean = texels_[texel];
  SurfaceMaterial m = surface_material(material);
  m.metallic = 1;
  if (material.metallic_roughness_texture) m.roughness = static_cast<float>(mean.roughness) / whole;
  for (int b = 0; b < 3; ++b) {
    const float root = static_cast<float>(mean.root_colour[b]) / whole;
    m.base_colour[b] = root * root;
  }
  m.shading = Frame(from_octahedral(Vec2d(mean.normal_u, mean.normal_v) / largest_code));
  return m;
}

}  // namespace penumbra
