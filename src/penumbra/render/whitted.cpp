#include "penumbra/render/airlight.h"
#include "penumbra/render/first_surface.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/spectral_sample.h"
#include "penumbra/render/wave_integrator.h"

namespace penumbra {
namespace {

constexpr int default_depth = 16;

/// Whitted 1979: shadow rays to every light, mirror and refraction rays followed recursively, until their weight falls
/// below a bound or the depth is reached; what they bring is returned up the tree.
///
/// Where surfaces and lights are plain, the recursion is unrolled into waves of rays.
class Whitted final : public WaveIntegrator {
 public:
  Whitted(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options)
      : WaveIntegrator(tracer, camera, options),
        tree_(tracer, options.front_sides_only, &textures()),
        airlight_(direct().lights(), direct().shadow()),
        max_depth_(options.max_depth > 0 ? options.max_depth : default_depth),
        min_throughput_(static_cast<float>(options.min_throughput)),
        spectral_(options.spectral) {
    prepare(tree_, options, {max_depth_, min_throughput_});
  }

  [[nodiscard]] PixelEstimate estimate(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const override {
    PixelEstimate seen;
    count(rays, RayPurpose::primary, 0);
    Eye eye(*this, sampler, rays, seen);
    const Bands bands = sample_bands(spectral_, sampler);
    seen.radiance =
        tree_.trace(ray, {.start = ray.origin, .differential = camera().differential(ray), .bands = bands}, eye);
    to_rgb(seen, bands);
    return seen;
  }

 private:
  /// What one camera ray sees, by the surfaces of its tree.
  class Eye final : public SpecularTree::Visitor {
   public:
    Eye(const Whitted& owner, PixelSampler& sampler, RayCounts& rays, PixelEstimate& seen)
        : owner_(owner), sampler_(sampler), rays_(rays), seen_(seen) {}

    Rgb surface(const SpecularTree::Node& node) override {
      const Material& material = owner_.tree_.tracer().scene().materials[node.point.material];
      const bool shines = material.unlit || emits_towards(material, node.point.geometric_normal, node.wo);
      Rgb radiance = shines ? node.surface.emission : Rgb(0);
      radiance += scattered(node, node.bsdf, node.branch.bands);
      if (material.fluorescence && node.branch.bands.spectral()) radiance += reradiated(node, *material.fluorescence);
      if (node.branch.depth == 0) {
        note_surface(seen_, node.ray, node.point, node.surface, node.bsdf,
                     airlight_ + node.passed * node.surface.alpha * radiance);
      }
      return radiance;
    }

    Rgb sky(const Ray& ray, const SpecularTree::Branch& branch) override {
      const Rgb radiance = branch.bands.emission(owner_.direct().lights().seen_in_sky(ray.direction));
      if (branch.depth == 0) note_miss(seen_, airlight_ + radiance);
      return radiance;
    }

    Rgb air(const SpecularTree::Stretch& stretch) override {
      const Airlight::Way way{stretch.ray, stretch.around, stretch.branch.interior, stretch.branch.bands};
      const Rgb radiance = owner_.airlight_.scattered_once(way, stretch.branch.depth, sampler_, rays_);
      if (stretch.branch.depth == 0) airlight_ = radiance;
      return radiance;
    }

    float followed(const Rgb& weight, int depth) override {
      return depth < owner_.max_depth_ && max_component(weight) >= owner_.min_throughput_ ? 1 : 0;
    }

    void count(bool refracted, int depth) override {
      penumbra::count(rays_, refracted ? RayPurpose::refraction : RayPurpose::reflection, depth);
    }

   private:
    // Light of the lamps and of the ambient term that the surface scatters towards the eye.
    Rgb scattered(const SpecularTree::Node& node, const Bsdf& bsdf, const Bands& bands) {
      Rgb radiance = bands.emission(owner_.direct().lights().ambient()) * bsdf.diffuse_reflectance();
      if (bsdf.has_spread()) {
        radiance += owner_.direct().reflected(node.point, bsdf, node.wo, followed_roughness, node.branch.depth,
                                              sampler_, rays_, bands);
      }
      return radiance;
    }

    // Light that it absorbs at shorter wavelengths and radiates at the eye's, as a white surface would scatter it.
    Rgb reradiated(const SpecularTree::Node& node, const Fluorescence& fluorescence) {
      const Absorption absorption = sample_absorption(fluorescence, node.branch.bands, sampler_);
      if (is_black(absorption.reradiation)) return Rgb(0);
      SurfaceMaterial white = node.surface;
      white.base_colour = Rgb(1);
      const Bsdf bsdf(white, frame_towards(white.shading, node.point.geometric_normal, node.wo),
                      node.point.geometric_normal);
      return absorption.reradiation * scattered(node, bsdf, absorption.bands);
    }

    const Whitted& owner_;
    PixelSampler& sampler_;
    RayCounts& rays_;
    PixelEstimate& seen_;
    Rgb airlight_{0};  ///< along the camera ray
  };

  Rgb trace(const Ray& ray, const Rgb& weight, int depth, const std::optional<RayDifferential>& differential,
            PixelSampler& sampler, RayCounts& rays) const override {
    PixelEstimate unseen;
    Eye eye(*this, sampler, rays, unseen);
    return tree_.trace(ray, {.weight = weight, .depth = depth, .start = ray.origin, .differential = differential}, eye);
  }

  SpecularTree tree_;
  Airlight airlight_;
  int max_depth_;
  float min_throughput_;
  bool spectral_;
};

}  // namespace

std::unique_ptr<Integrator> make_whitted(const RayTracer& tracer, const CameraRays& camera,
                                         const RenderOptions& options) {
  return std::make_unique<Whitted>(tracer, camera, options);
}

}  // namespace penumbra
