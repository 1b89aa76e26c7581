#include "penumbra/render/two_pass.h"

#include <algorithm>
#include <bit>
#include <numbers>

#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"
#include "penumbra/render/direct_light.h"
#include "penumbra/render/first_surface.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/tracing/shading/specular_tree.h"

namespace penumbra {
namespace {

constexpr int default_depth = 16;
constexpr auto inverse_pi = static_cast<float>(std::numbers::inv_pi);
/// Shadow rays to a lamp at a point, over all samples of a pixel, and for each sample at least.
constexpr int shadow_rays_a_pixel = 64;
constexpr int fewest_shadow_rays = 4;
/// Gathered light in mirrors needs fewer rays.
constexpr int gather_share_in_mirrors = 4;

DiffuseLight::Place place_of(const SpecularTree::Node& node) {
  const Vec3d& n = node.bsdf.shading_normal();
  return {node.point, node.front ? node.point.geometric_normal : -node.point.geometric_normal,
          dot(n, node.wo) < 0 ? -n : n};
}

class TwoPass final : public RayIntegrator {
 public:
  TwoPass(const RayTracer& tracer, const DiffuseLight& light, const CameraRays& camera, const RenderOptions& options)
      : RayIntegrator(camera, options.seed),
        textures_(tracer),
        tree_(tracer, options.front_sides_only, &textures_),
        light_(light),
        gloss_light_(tracer, false, false),
        max_depth_(options.max_depth > 0 ? options.max_depth : default_depth),
        min_throughput_(static_cast<float>(options.min_throughput)),
        gather_(options.final_gather),
        shadow_rays_(
            static_cast<std::uint32_t>(std::max(fewest_shadow_rays, shadow_rays_a_pixel / options.samples_per_pixel))) {
  }

  [[nodiscard]] PixelEstimate estimate(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const override;

 private:
  class Eye;

  FilteredTextures textures_;
  SpecularTree tree_;
  const DiffuseLight& light_;
  DirectLight gloss_light_;
  int max_depth_;
  float min_throughput_;
  int gather_;
  std::uint32_t shadow_rays_;
};

/// What one camera ray sees or, from a diffuse surface, one gathering ray.
class TwoPass::Eye final : public SpecularTree::Visitor {
 public:
  /// @param seen the layers of a camera ray; none: a gathering ray, which sees no lamps where it lands and takes all
  /// light as the elements have it.
  Eye(const TwoPass& owner, PixelSampler& sampler, RayCounts& rays, PixelEstimate* seen)
      : owner_(owner), sampler_(sampler), rays_(rays), seen_(seen) {}

  Rgb surface(const SpecularTree::Node& node) override {
    const Rgb shining = emitted(node);
    Rgb radiance = shining + diffuse(node) + gloss(node);
    if (seen_ != nullptr && node.branch.depth == 0) {
      note_surface(*seen_, node.ray, node.point, node.surface, node.bsdf,
                   node.passed * node.surface.alpha * (shining + straight_));
    }
    return radiance;
  }

  Rgb sky(const Ray& ray, const SpecularTree::Branch& branch) override {
    const EnvironmentMap& environment = owner_.gloss_light_.lights().environment();
    if (branch.depth == lampless_depth_ && environment.lights_surfaces()) return Rgb(0);
    if (seen_ == nullptr && !environment.lights_surfaces()) return Rgb(0);
    const Rgb radiance = seen_ != nullptr ? owner_.gloss_light_.lights().seen_in_sky(ray.direction)
                                          : environment.radiance(ray.direction);
    if (seen_ != nullptr && branch.depth == 0) note_miss(*seen_, radiance);
    return radiance;
  }

  float followed(const Rgb& weight, int depth) override {
    return depth < owner_.max_depth_ && max_component(weight) >= owner_.min_throughput_ ? 1 : 0;
  }

  void count(bool refracted, int depth) override {
    penumbra::count(rays_, refracted ? RayPurpose::refraction : RayPurpose::reflection, depth);
  }

 private:
  [[nodiscard]] Rgb emitted(const SpecularTree::Node& node) const {
    const Material& material = owner_.tree_.tracer().scene().materials[node.point.material];
    if (material.unlit) return seen_ != nullptr ? node.surface.emission : Rgb(0);
    if (is_black(node.surface.emission) || node.branch.depth == lampless_depth_) return Rgb(0);
    if (!emits_towards(material, node.point.geometric_normal, node.wo)) return Rgb(0);
    if (seen_ == nullptr && node.branch.depth == 0 && owner_.light_.is_lamp(place_of(node))) return Rgb(0);
    return node.surface.emission;
  }

  /// Light of the first pass, or its indirect part gathered.
  Rgb diffuse(const SpecularTree::Node& node) {
    straight_ = Rgb(0);
    const Rgb reflectance = node.bsdf.diffuse_albedo(node.wo);
    if (is_black(reflectance)) return Rgb(0);
    const DiffuseLight::Place place = place_of(node);
    if (seen_ == nullptr) return reflectance * inverse_pi * owner_.light_.total(place);
    const std::uint64_t key = std::bit_cast<std::uint64_t>(sampler_.next_1d());
    straight_ = reflectance * inverse_pi * owner_.light_.direct(place, hash_key(key), owner_.shadow_rays_);
    const Rgb straight = straight_;
    const Rgb indirect = owner_.gather_ > 0 ? gather(node, place, key) : owner_.light_.indirect(place);
    straight_ = straight;
    return straight + reflectance * inverse_pi * indirect;
  }

  /// Indirect irradiance by rays that look the solution up where they land.
  Rgb gather(const SpecularTree::Node& node, const DiffuseLight::Place& place, std::uint64_t key) {
    const int count = node.branch.depth == 0 ? owner_.gather_ : std::max(1, owner_.gather_ / gather_share_in_mirrors);
    const Frame frame(place.normal);
    Rgb sum(0);
    for (int k = 0; k < count; ++k) {
      const Vec2d u = owen_sobol_2d(static_cast<std::uint32_t>(k), hash_key(key, 1));
      const Vec3d direction = frame.to_world(sample_cosine_hemisphere(u));
      if (!(dot(direction, place.side) > 0)) continue;
      penumbra::count(rays_, RayPurpose::diffuse, node.branch.depth + 1);
      Eye afar(owner_, sampler_, rays_, nullptr);
      sum += owner_.tree_.trace(leave(node.point, direction),
                                {.start = node.point.position, .interior = node.branch.interior}, afar);
    }
    return std::numbers::pi_v<float> / static_cast<float>(count) * sum;
  }

  /// Lobes with spread: shadow rays to the lights, and one ray by chance that sees all but these.
  Rgb gloss(const SpecularTree::Node& node) {
    const SurfaceMaterial& s = node.surface;
    if (s.roughness <= static_cast<float>(followed_roughness)) return Rgb(0);
    if (seen_ == nullptr && !(s.metallic > 0 || s.transmission > 0)) return Rgb(0);  // a faint layer, from afar
    const Bsdf lobes = node.bsdf.without_base();
    if (!lobes.has_spread()) return Rgb(0);
    Rgb radiance = owner_.gloss_light_.reflected(node.point, lobes, node.wo, followed_roughness, node.branch.depth,
                                                 sampler_, rays_);
    const double u_lobe = sampler_.next_1d();
    const auto chosen = lobes.sample(node.wo, u_lobe, sampler_.next_2d());
    if (!chosen || chosen->ideal) return radiance;  // ideal lobes are the tree's
    const int before = lampless_depth_;
    lampless_depth_ = node.branch.depth + 1;
    radiance +=
        owner_.tree_.follow(node.point, node.branch, chosen->direction, chosen->weight, chosen->transmitted, *this);
    lampless_depth_ = before;
    return radiance;
  }

  const TwoPass& owner_;
  PixelSampler& sampler_;
  RayCounts& rays_;
  PixelEstimate* seen_;
  Rgb straight_{0};          // of the surface at hand, straight from the lamps
  int lampless_depth_ = -1;  // rays of this depth see no lights: shadow rays found them
};

PixelEstimate TwoPass::estimate(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const {
  PixelEstimate seen;
  count(rays, RayPurpose::primary, 0);
  Eye eye(*this, sampler, rays, &seen);
  seen.radiance = tree_.trace(ray, {.start = ray.origin, .differential = camera().differential(ray)}, eye);
  return seen;
}

}  // namespace

std::unique_ptr<Integrator> make_two_pass(const RayTracer& tracer, const DiffuseLight& light, const CameraRays& camera,
                                          const RenderOptions& options) {
  return std::make_unique<TwoPass>(tracer, light, camera, options);
}

}  // namespace penumbra
