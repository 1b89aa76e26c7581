#include "penumbra/render/first_surface.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/wave_integrator.h"

namespace penumbra {
namespace {

/// Appel 1968: a ray through each sub-pixel to the nearest surface, and from there one to each light.
class Appel final : public WaveIntegrator {
 public:
  Appel(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options)
      : WaveIntegrator(tracer, camera, options), tracer_(tracer), front_sides_only_(options.front_sides_only) {
    prepare(SpecularTree(tracer, options.front_sides_only), options, {});
  }

  [[nodiscard]] PixelEstimate estimate(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const override {
    count(rays, RayPurpose::primary, 0);
    return shade(ray, sampler, rays);
  }

 private:
  [[nodiscard]] PixelEstimate shade(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const;

  Rgb trace(const Ray& ray, const Rgb&, int, const std::optional<RayDifferential>&, PixelSampler& sampler,
            RayCounts& rays) const override {
    return shade(ray, sampler, rays).radiance;
  }
  [[nodiscard]] SurfaceMaterial surface_met(const Ray& ray, const SurfacePoint& point) const;

  const RayTracer& tracer_;
  bool front_sides_only_;
};

PixelEstimate Appel::shade(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const {
  PixelEstimate seen;
  const auto hit = tracer_.nearest(ray);
  if (!hit) {
    seen.radiance = direct().lights().environment().radiance(ray.direction);
    note_miss(seen, seen.radiance);
    return seen;
  }
  const SurfacePoint point = tracer_.surface_point(ray, *hit);
  const Vec3d wo = -ray.direction;
  const Material& material = tracer_.scene().materials[point.material];
  if (front_sides_only_ && dot(point.geometric_normal, wo) < 0) return seen;
  const SurfaceMaterial surface = surface_met(ray, point);
  const Bsdf bsdf(surface, frame_towards(surface.shading, point.geometric_normal, wo), point.geometric_normal);
  if (material.unlit || emits_towards(material, point.geometric_normal, wo)) seen.radiance = surface.emission;
  seen.radiance += direct().lights().ambient() * bsdf.diffuse_reflectance();
  if (bsdf.has_spread()) seen.radiance += direct().reflected(point, bsdf, wo, 0, 0, sampler, rays);
  note_surface(seen, ray, point, surface, bsdf, seen.radiance);
  return seen;
}

SurfaceMaterial Appel::surface_met(const Ray& ray, const SurfacePoint& point) const {
  if (!textures().any()) return surface_material(tracer_.scene(), point);
  const Footprint footprint = footprint_of(ray, camera().differential(ray), point);
  const FilteredTextures::View view(textures(), point, footprint);
  return surface_material(tracer_.scene(), point, &view);
}

}  // namespace

std::unique_ptr<Integrator> make_appel(const RayTracer& tracer, const CameraRays& camera,
                                       const RenderOptions& options) {
  return std::make_unique<Appel>(tracer, camera, options);
}

}  // namespace penumbra
