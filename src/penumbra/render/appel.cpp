#include "penumbra/render/direct_light.h"
#include "penumbra/render/first_surface.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/ray_waves.h"
#include "penumbra/render/shadow_scout.h"

namespace penumbra {
namespace {

/// Appel 1968: a ray through each sub-pixel to the nearest surface, and from there one to each light.
///
/// Where surfaces and lights are plain the rays go sixteen at a time (RayWaves). Both ways draw the same random numbers
/// and differ by rounding alone.
class Appel final : public RayIntegrator, private RayWaves::Others {
 public:
  Appel(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options)
      : RayIntegrator(camera, options.seed),
        tracer_(tracer),
        camera_(camera),
        direct_(tracer, options),
        textures_(tracer),
        front_sides_only_(options.front_sides_only) {
    if (direct_.is_selective()) {
      const SpecularTree tree(tracer, options.front_sides_only);
      direct_.send_more_at(scout_shadows(direct_, tree, camera, options, first_pass_));
    }
    if (front_sides_only_ || !direct_.sends_one_ray_each()) return;
    waves_ = RayWaves::make(tracer, camera_, direct_.lights(),
                            {.max_depth = 0,
                             .at_middles = options.samples_per_pixel == 1,
                             .through_glass = !options.opaque_shadows,
                             .textures = &textures_,
                             .seed = options.seed});
  }

  [[nodiscard]] RayCounts first_pass() const override { return first_pass_; }

  using RayIntegrator::render;
  void render(std::span<const PixelBlock> blocks, Film& film, RayCounts& rays) const override {
    waves_ && !film.has_layers() ? waves_->render(blocks, *this, film, rays)
                                 : RayIntegrator::render(blocks, film, rays);
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
  CameraRays camera_;
  DirectLight direct_;
  RayCounts first_pass_;
  FilteredTextures textures_;
  bool front_sides_only_;
  std::unique_ptr<RayWaves> waves_;
};

PixelEstimate Appel::shade(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const {
  PixelEstimate seen;
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
  const SurfaceMaterial surface = surface_met(ray, point);
  const Bsdf bsdf(surface, frame_towards(surface.shading, point.geometric_normal, wo), point.geometric_normal);
  if (material.unlit || emits_towards(material, point.geometric_normal, wo)) seen.radiance = surface.emission;
  seen.radiance += direct_.lights().ambient() * bsdf.diffuse_reflectance();
  if (bsdf.has_spread()) seen.radiance += direct_.reflected(point, bsdf, wo, 0, 0, sampler, rays);
  note_surface(seen, ray, point, surface, bsdf, seen.radiance);
  return seen;
}

SurfaceMaterial Appel::surface_met(const Ray& ray, const SurfacePoint& point) const {
  if (!textures_.any()) return surface_material(tracer_.scene(), point);
  const Footprint footprint = footprint_of(ray, camera_.differential(ray), point);
  const FilteredTextures::View view(textures_, point, footprint);
  return surface_material(tracer_.scene(), point, &view);
}

}  // namespace

std::unique_ptr<Integrator> make_appel(const RayTracer& tracer, const CameraRays& camera,
                                       const RenderOptions& options) {
  return std::make_unique<Appel>(tracer, camera, options);
}

}  // namespace penumbra
