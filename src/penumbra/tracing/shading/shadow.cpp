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

Shadow::Shadow(const RayTracer& tracer, bool through_glass) : tracer_(&tracer), through_glass_(through_glass) {
  const auto& materials = tracer.scene().materials;
  binary_ = std::none_of(materials.begin(), materials.end(),
                         [&](const Material& m) { return lets_light_pass(m, through_glass); });
}

Rgb Shadow::transmittance(const Ray& ray) const {
  if (binary_) return Rgb(tracer_->occluded(ray) ? 0.0F : 1.0F);
  const Scene& scene = tracer_->scene();
  Rgb passed(1);
  Vec3d entered = ray.origin;  // where the ray last went into or out of glass
  Ray rest = ray;
  const Vec3d end = ray.at(std::isfinite(ray.t_max) ? ray.t_max : 0);
  for (int crossed = 0; crossed < most_surfaces; ++crossed) {
    const auto hit = tracer_->nearest(rest);
    if (!hit) return passed;
    const SurfacePoint point = tracer_->surface_point(rest, *hit);
    const Material& material = scene.materials[point.material];
    if (!lets_light_pass(material, through_glass_)) return Rgb(0);
    if (through_glass_ && material.transmission > 0 && !material.thin_walled) {
      if (dot(point.geometric_normal, ray.direction) > 0) {
        passed *= volume_transmittance(material.attenuation_colour, material.attenuation_distance,
                                       length(point.position - entered));
      }
      entered = point.position;
    }
    passed *= crossing(surface_material(scene, point), point.geometric_normal, ray.direction, through_glass_);
    if (is_black(passed)) return passed;
    rest = leave(point, ray.direction);
    if (std::isfinite(ray.t_max)) {
      rest.t_max = dot(end - rest.origin, ray.direction);
      if (rest.t_max <= 0) return passed;
    }
  }
  return Rgb(0);
}

}  // namespace penumbra
