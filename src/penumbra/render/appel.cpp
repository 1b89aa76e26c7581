#include "penumbra/render/direct_light.h"
#include "penumbra/render/first_surface.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/ray_tally.h"

namespace penumbra {
namespace {

/// Appel 1968: a ray through each sub-pixel to the nearest surface, and from there one to each light.
class Appel final : public RayIntegrator {
 public:
  Appel(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options)
      : RayIntegrator(camera, options.seed),
        tracer_(tracer),
        direct_(tracer, !options.opaque_shadows),
        front_sides_only_(options.front_sides_only) {}

  [[nodiscard]] PixelEstimate estimate(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const override {
    PixelEstimate seen;
    count(rays, RayPurpose::primary, 0);
    const auto hit = tracer_.nearest(ray);
    if (!hit) {
      seen.radiance = direct_.lights().environment().radiance(ray.direction);
      note_miss(seen, seen.radiance);
      return seen;
    }
    const SurfacePoint point = tracer_.surface_point(ray, *hit);
    const Vec3d wo = -ray.direction;
    const Material& material = tracer_.scene().materials[point.material];
    if (front_sides_only_ && dot(point.geometric_normal, wo) < 0) return seen;
    const SurfaceMaterial surface = surface_material(tracer_.scene(), point);
    const Bsdf bsdf(surface, frame_towards(surface.shading, point.geometric_normal, wo), point.geometric_normal);
    if (material.unlit || emits_towards(material, point.geometric_normal, wo)) seen.radiance = surface.emission;
    seen.radiance += direct_.lights().ambient() * bsdf.diffuse_reflectance();
    if (bsdf.has_spread()) seen.radiance += direct_.reflected(point, bsdf, wo, 0, 0, sampler, rays);
    note_surface(seen, ray, point, surface, bsdf, seen.radiance);
    return seen;
  }

 private:
  const RayTracer& tracer_;
  DirectLight direct_;
  bool front_sides_only_;
};

}  // namespace

std::unique_ptr<Integrator> make_appel(const RayTracer& tracer, const CameraRays& camera,
                                       const RenderOptions& options) {
  return std::make_unique<Appel>(tracer, camera, options);
}

}  // namespace penumbra
