#include "penumbra/math/spectrum.h"
#include "penumbra/render/direct_light.h"
#include "penumbra/render/first_surface.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/interior.h"
#include "penumbra/render/ray_tally.h"

namespace penumbra {
namespace {

// Lobes up to this roughness are followed by mirror and refraction rays (docs/guide/rendering.md).
constexpr double followed_roughness = 0.1;
constexpr int default_depth = 16;

/// Whitted 1979: shadow rays to every light, mirror and refraction rays followed recursively, each with the weight it
/// carries to the picture, until the weight falls below a bound or the depth is reached; what they bring is returned up
/// the tree.
class Whitted final : public RayIntegrator {
 public:
  Whitted(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options)
      : RayIntegrator(camera, options.seed),
        tracer_(tracer),
        direct_(tracer, !options.opaque_shadows, options.samples_per_pixel == 1),
        max_depth_(options.max_depth > 0 ? options.max_depth : default_depth),
        min_throughput_(options.min_throughput),
        front_sides_only_(options.front_sides_only) {}

  [[nodiscard]] PixelEstimate estimate(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const override {
    PixelEstimate seen;
    count(rays, RayPurpose::primary, 0);
    Branch root{.weight = Rgb(1), .depth = 0, .start = ray.origin, .interior = {}};
    seen.radiance = trace(ray, root, sampler, rays, &seen);
    return seen;
  }

 private:
  // A ray of the tree: its weight in the picture, its depth, and the media it travels in.
  struct Branch {
    Rgb weight;
    int depth;
    Vec3d start;  // the point that it leaves; the ray itself starts a rounding error beside it
    Interior interior;
  };

  Rgb trace(const Ray& ray, const Branch& branch, PixelSampler& sampler, RayCounts& rays, PixelEstimate* seen) const;
  Rgb follow(const SurfacePoint& point, const Vec3d& direction, const Rgb& weight, const Branch& parent,
             RayPurpose purpose, PixelSampler& sampler, RayCounts& rays) const;

  const RayTracer& tracer_;
  DirectLight direct_;
  int max_depth_;
  double min_throughput_;
  bool front_sides_only_;
};

Rgb Whitted::trace(const Ray& ray, const Branch& branch, PixelSampler& sampler, RayCounts& rays,
                   PixelEstimate* seen) const {
  const auto hit = tracer_.nearest(ray);
  if (!hit) {
    const Rgb sky = direct_.lights().environment().radiance(ray.direction);
    if (seen) note_miss(*seen, sky);
    return sky;
  }
  const SurfacePoint point = tracer_.surface_point(ray, *hit);
  const Vec3d wo = -ray.direction;
  const bool front = dot(point.geometric_normal, wo) > 0;
  const Material& material = tracer_.scene().materials[point.material];
  const Rgb passed =
      branch.interior.transmittance(tracer_.scene(), point, front, length(point.position - branch.start));
  if (front_sides_only_ && !front && material.transmission == 0) return Rgb(0);

  const SurfaceMaterial surface = surface_material(tracer_.scene(), point);
  const Bsdf bsdf(surface, frame_towards(surface.shading, point.geometric_normal, wo), point.geometric_normal);
  const bool shines = material.unlit || emits_towards(material, point.geometric_normal, wo);
  Rgb radiance = shines ? surface.emission : Rgb(0);
  radiance += direct_.lights().ambient() * bsdf.diffuse_reflectance();
  if (bsdf.has_spread()) {
    radiance += direct_.reflected(point, bsdf, wo, followed_roughness, branch.depth, sampler, rays);
  }
  if (seen) note_surface(*seen, ray, point, surface, bsdf, passed * surface.alpha * radiance);

  Branch here = branch;
  here.weight *= passed * surface.alpha;
  const SpecularSplit split = bsdf.specular_split(wo, followed_roughness);
  if (!is_black(split.reflected)) {
    radiance += follow(point, split.reflection_direction, split.reflected, here, RayPurpose::reflection, sampler, rays);
  }
  if (!is_black(split.refracted)) {
    radiance += follow(point, split.refraction_direction, split.refracted, here, RayPurpose::refraction, sampler, rays);
  }
  radiance *= surface.alpha;
  if (surface.alpha < 1) {
    here.weight = branch.weight * passed;
    radiance += follow(point, ray.direction, Rgb(1 - surface.alpha), here, RayPurpose::refraction, sampler, rays);
  }
  return passed * radiance;
}

Rgb Whitted::follow(const SurfacePoint& point, const Vec3d& direction, const Rgb& weight, const Branch& parent,
                    RayPurpose purpose, PixelSampler& sampler, RayCounts& rays) const {
  const Rgb carried = parent.weight * weight;
  if (parent.depth >= max_depth_ || max_component(carried) < static_cast<float>(min_throughput_)) return Rgb(0);
  Branch child{.weight = carried, .depth = parent.depth + 1, .start = point.position, .interior = parent.interior};
  child.interior.cross(tracer_.scene(), point, direction, purpose == RayPurpose::refraction);
  count(rays, purpose, child.depth);
  return weight * trace(leave(point, direction), child, sampler, rays, nullptr);
}

}  // namespace

std::unique_ptr<Integrator> make_whitted(const RayTracer& tracer, const CameraRays& camera,
                                         const RenderOptions& options) {
  return std::make_unique<Whitted>(tracer, camera, options);
}

}  // namespace penumbra
