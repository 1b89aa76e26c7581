#include "penumbra/tracing/shading/shadow.h"

#include <algorithm>
#include <cmath>

#include "penumbra/tracing/shading/fresnel.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {
namespace {

// A light behind so many transparent surfaces counts as hidden; it bounds the loop when surfaces coincide.
constexpr int most_surfaces = 64;

bool lets_light_pass(const Material& m, bool through_glass) {
  return m.alpha_mode == AlphaMode::blend || (through_glass && m.transmission > 0);
}

// What one transparent surface leaves of a ray that crosses it straight.
Rgb crossing(const SurfaceMaterial& surface, const Vec3d& normal, const Vec3d& direction, bool through_glass) {
  Rgb passed(1 - surface.alpha);
  if (through_glass && surface.transmission > 0) {
    const double cosine = std::min(1.0, std::abs(dot(normal, direction)));
    // By the cosine outside also where the ray is inside: it goes straight, so it never meets total reflection.
    const double reflected = surface.ior == 0 ? 1.0 : fresnel_dielectric(cosine, 1, surface.ior).mean();
    // A pane is crossed with all its inner reflections, unpolarised, as Bsdf does it.
    const double through = (1 - reflected) / (surface.thin_walled ? 1 + reflected : 1);
    passed += surface.alpha * surface.transmission * (1 - surface.metallic) * static_cast<float>(through) *
              surface.base_colour;
  }
  return passed;
}

}  // namespace

Shadow::Shadow(const RayTracer& tracer, bool through_glass)
    : tracer_(&tracer), media_(tracer.scene()), through_glass_(through_glass) {
  const auto& materials = tracer.scene().materials;
  binary_ = std::none_of(materials.begin(), materials.end(),
                         [&](const Material& m) { return lets_light_pass(m, through_glass); });
}

// A ray on its way through transparent surfaces.
struct Shadow::Passage {
  Ray rest;
  Vec3d end{0};      // of the whole ray
  Vec3d entered{0};  // where the ray last went into or out of glass
  Interior interior{};
  Rgb passed{1};

  explicit Passage(const Ray& ray, const Interior& inside = {})
      : rest(ray), end(ray.at(std::isfinite(ray.t_max) ? ray.t_max : 0)), entered(ray.origin), interior(inside) {}
};

// Takes the ray through the surface that it met. False when it ends there: nothing passed, or its end is reached.
bool Shadow::go_through(Passage& way, const Hit& hit, const Bands& bands) const {
  const Scene& scene = tracer_->scene();
  const Vec3d direction = way.rest.direction;
  const SurfacePoint point = tracer_->surface_point(way.rest, hit);
  const Material& material = scene.materials[point.material];
  if (!lets_light_pass(material, through_glass_)) {
    way.passed = Rgb(0);
    return false;
  }
  if (through_glass_ && material.transmission > 0 && !material.thin_walled) {
    if (dot(point.geometric_normal, direction) > 0) {
      way.passed *= volume_transmittance(bands.reflectance(material.attenuation_colour), material.attenuation_distance,
                                         length(point.position - way.entered));
    }
    way.entered = point.position;
  }
  if (!media_.none()) {
    Ray before = way.rest;
    before.t_max = hit.t;
    const bool front = dot(point.geometric_normal, direction) < 0;
    way.passed *= media_.transmittance(way.interior.around(scene, point, front), before, bands);
    way.interior.cross(scene, point, direction, true);
  }
  way.passed *= crossing(surface_material(scene, point, bands), point.geometric_normal, direction, through_glass_);
  if (is_black(way.passed)) return false;
  const double t_max = way.rest.t_max;
  way.rest = leave(point, direction);
  if (std::isfinite(t_max)) {
    way.rest.t_max = dot(way.end - way.rest.origin, direction);
    if (way.rest.t_max <= 0) return false;
  }
  return true;
}

Rgb Shadow::transmittance(const Ray& ray, const Interior& inside, const Bands& bands) const {
  const bool clear = media_.none();
  if (binary_) {
    if (tracer_->occluded(ray)) return Rgb(0);
    return clear ? Rgb(1) : media_.transmittance(inside.innermost(), ray, bands);
  }
  Passage way(ray, inside);
  for (int crossed = 0; crossed < most_surfaces; ++crossed) {
    const auto hit = tracer_->nearest(way.rest);
    if (!hit) return clear ? way.passed : way.passed * media_.transmittance(way.interior.innermost(), way.rest, bands);
    if (!go_through(way, *hit, bands)) return way.passed;
  }
  return Rgb(0);
}

bool Shadow::passes(const HitPacket& hits, int lane) const {
  const Scene& scene = tracer_->scene();
  const std::uint32_t object = hits.object[lane];
  const std::uint32_t material = object < scene.instances.size()
                                     ? scene.meshes[scene.instances[object].mesh].material_of(hits.primitive[lane])
                                     : scene.shapes[object - scene.instances.size()].material;
  return lets_light_pass(scene.materials[material], through_glass_);
}

}  // namespace penumbra
