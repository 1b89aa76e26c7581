#include <bit>
#include <cmath>

#include "penumbra/math/sampling.h"
#include "penumbra/math/spectrum.h"
#include "penumbra/render/airlight.h"
#include "penumbra/render/first_surface.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/path_survival.h"
#include "penumbra/render/path_waves.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/spectral_sample.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/interior.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "penumbra/tracing/shading/phase_function.h"
#include "penumbra/tracing/shading/shadow.h"

namespace penumbra {
namespace {

// Scatterings before which light in the air is also looked for by equiangular distances: where it is seen.
constexpr int equiangular_bounces = 2;

Vec3d facing(const Bsdf& bsdf, const Vec3d& wo) {
  const Vec3d& n = bsdf.shading_normal();
  return dot(n, wo) < 0 ? -n : n;
}

/// Path tracing (Kajiya 1986): the reference. Each bounce samples a light and the BSDF, joined by multiple importance
/// sampling; Russian roulette ends paths without bias. Where all is matt and lamps are flat, paths are traced in waves
/// (PathWaves).
class Path final : public RayIntegrator {
 public:
  Path(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options)
      : RayIntegrator(camera, options.seed),
        tracer_(tracer),
        lights_(tracer.scene()),
        shadow_(tracer, false),
        airlight_(lights_, shadow_),
        textures_(tracer),
        max_depth_(options.max_depth),
        caustics_(options.caustics),
        front_sides_only_(options.front_sides_only),
        spectral_(options.spectral),
        camera_(camera) {
    if (!front_sides_only_) {
      waves_ = PathWaves::make(tracer, camera_, lights_,
                               {.max_depth = max_depth_, .spectral = spectral_, .seed = options.seed});
    }
  }

  using RayIntegrator::render;
  void render(std::span<const PixelBlock> blocks, Film& film, RayCounts& rays) const override {
    waves_ && !film.has_layers() ? waves_->render(blocks, film, rays) : RayIntegrator::render(blocks, film, rays);
  }

  [[nodiscard]] PixelEstimate estimate(const Ray& ray, PixelSampler& sampler, RayCounts& rays) const override {
    const Bands bands = sample_bands(spectral_, sampler);
    PixelEstimate seen = follow(ray, bands, sampler, rays);
    to_rgb(seen, bands);
    return seen;
  }

 private:
  // The state of a path at its current ray.
  struct Walk {
    Ray ray;
    Vec3d start{0};  // the point that the ray leaves; it starts a rounding error beside it
    Rgb throughput{1};
    int depth = 0;        // bounces so far
    double bsdf_pdf = 0;  // of the last direction; 0 after an ideal bounce and for camera rays: only BSDF sampling can
                          // find light then
    Vec3d last_position{0};
    Vec3d last_facing{0};      // the shading normal there, on the side the path came from
    bool mirrors_only = true;  // no lobe with spread yet
    Interior interior;
    // Of the ray, until the first bounce with spread: from there on textures are read at points.
    std::optional<RayDifferential> differential;
    Footprint footprint;  // of the surface that it met
    Bands bands;          // what the components of throughput and light stand for
  };

  [[nodiscard]] PixelEstimate follow(const Ray& ray, const Bands& bands, PixelSampler& sampler, RayCounts& rays) const;

  [[nodiscard]] Rgb sky(const Walk& walk) const;
  [[nodiscard]] Rgb emitted(const Walk& walk, const SurfacePoint& point, const SurfaceMaterial& surface) const;
  [[nodiscard]] static bool was_absorbed(Walk& walk, const Fluorescence& fluorescence, const SurfaceMaterial& surface,
                                         PixelSampler& sampler);
  [[nodiscard]] Rgb light_by_sampling(const Walk& walk, const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo,
                                      PixelSampler& sampler, RayCounts& rays) const;
  // Whether a walk ends here, by depth or Russian roulette; else it is one bounce deeper.
  [[nodiscard]] static bool goes_on(Walk& walk, PixelSampler& sampler);
  // Takes the walk through the media on its way to `hit`; true when it was scattered before.
  [[nodiscard]] bool scatters_before(const std::optional<Hit>& hit, Walk& walk, PixelEstimate& seen,
                                     PixelSampler& sampler, RayCounts& rays) const;
  void scatter(const Media::Flight& flight, Walk& walk, PixelSampler& sampler) const;
  [[nodiscard]] bool bounce(Walk& walk, const SurfacePoint& point, const SurfaceMaterial& surface, const Bsdf& bsdf,
                            PixelSampler& sampler, RayCounts& rays) const;
  [[nodiscard]] SurfaceMaterial surface_met(Walk& walk, const SurfacePoint& point) const;
  void turn_differential(Walk& walk, const SurfacePoint& point, const SurfaceMaterial& surface, const Bsdf& bsdf,
                         const BsdfSample& to) const;

  const RayTracer& tracer_;
  LightSampler lights_;
  Shadow shadow_;
  Airlight airlight_;
  FilteredTextures textures_;
  int max_depth_;
  bool caustics_;
  bool front_sides_only_;
  bool spectral_;
  CameraRays camera_;
  std::unique_ptr<PathWaves> waves_;
};

PixelEstimate Path::follow(const Ray& ray, const Bands& bands, PixelSampler& sampler, RayCounts& rays) const {
  PixelEstimate seen;
  Walk walk;
  walk.bands = bands;
  walk.ray = ray;
  walk.start = ray.origin;
  if (textures_.any()) walk.differential = camera().differential(ray);
  count(rays, RayPurpose::primary, 0);
  while (true) {
    const auto hit = tracer_.nearest(walk.ray);
    if (!shadow_.media().none() && scatters_before(hit, walk, seen, sampler, rays)) {
      if (is_black(walk.throughput) || !goes_on(walk, sampler)) return seen;
      count(rays, RayPurpose::diffuse, walk.depth);
      continue;
    }
    if (!hit) {
      const Rgb light = walk.throughput * sky(walk);
      seen.radiance += light;
      if (walk.depth == 0) note_miss(seen, seen.direct + light);
      if (walk.depth == 1) seen.direct += light;
      return seen;
    }
    const SurfacePoint point = tracer_.surface_point(walk.ray, *hit);
    const Vec3d wo = -walk.ray.direction;
    const bool front = dot(point.geometric_normal, wo) > 0;
    walk.throughput *=
        walk.interior.transmittance(tracer_.scene(), point, front, length(point.position - walk.start), walk.bands);
    const Material& material = tracer_.scene().materials[point.material];
    if (front_sides_only_ && !front && material.transmission == 0) return seen;

    SurfaceMaterial surface = surface_met(walk, point);
    if (surface.alpha < 1 && sampler.next_1d() >= surface.alpha) {
      count(rays, RayPurpose::refraction, walk.depth);
      walk.start = point.position;
      walk.interior.cross(tracer_.scene(), point, walk.ray.direction, true);
      if (walk.differential) walk.differential = passed_on(*walk.differential, walk.footprint);
      walk.ray = leave(point, walk.ray.direction);  // seen through; the walk's memory of its last bounce stays
      continue;
    }
    Rgb light = walk.throughput * emitted(walk, point, surface);
    if (walk.bands.spectral() && disperses(material)) leave_hero_alone(walk.throughput);
    const Frame shading = frame_towards(surface.shading, point.geometric_normal, wo);
    Bsdf bsdf(surface, shading, point.geometric_normal);
    if (walk.depth == 0) note_surface(seen, ray, point, surface, bsdf, seen.direct);
    if (walk.depth <= 1) seen.direct += light;
    seen.radiance += light;

    if (max_depth_ > 0 && walk.depth >= max_depth_) return seen;
    if (walk.bands.spectral() && material.fluorescence &&
        was_absorbed(walk, *material.fluorescence, surface, sampler)) {
      surface.base_colour = Rgb(1);
      bsdf = Bsdf(surface, shading, point.geometric_normal);
    }
    if (bsdf.has_spread()) {
      light = walk.throughput * light_by_sampling(walk, point, bsdf, wo, sampler, rays);
      if (walk.depth == 0) seen.direct += light;
      seen.radiance += light;
    }
    if (!bounce(walk, point, surface, bsdf, sampler, rays)) return seen;
  }
}

SurfaceMaterial Path::surface_met(Walk& walk, const SurfacePoint& point) const {
  if (!walk.differential) return surface_material(tracer_.scene(), point, walk.bands);
  walk.footprint = footprint_of(walk.ray, *walk.differential, point);
  const FilteredTextures::View view(textures_, point, walk.footprint);
  return surface_material(tracer_.scene(), point, walk.bands, &view);
}

// Before the walk turns to the ray that goes on.
void Path::turn_differential(Walk& walk, const SurfacePoint& point, const SurfaceMaterial& surface, const Bsdf& bsdf,
                             const BsdfSample& to) const {
  if (!walk.differential) return;
  if (!to.ideal) {
    walk.differential.reset();
  } else if (to.transmitted) {
    const bool front = dot(point.geometric_normal, walk.ray.direction) < 0;
    walk.differential = refracted(tracer_, walk.ray, *walk.differential, walk.footprint, point, bsdf.shading_normal(),
                                  to.direction, relative_index(surface, front));
  } else {
    walk.differential = reflected(tracer_, walk.ray, *walk.differential, walk.footprint, point, bsdf.shading_normal());
  }
}

// What a fluorescent surface sends along the path it either reflected, at the path's own wavelengths, or absorbed at
// shorter ones and radiated again. One of the two is followed, with a chance in proportion to what it would carry: when
// true, the walk goes on at the wavelengths that were absorbed, as if from a white surface.
bool Path::was_absorbed(Walk& walk, const Fluorescence& fluorescence, const SurfaceMaterial& surface,
                        PixelSampler& sampler) {
  const Absorption absorption = sample_absorption(fluorescence, walk.bands, sampler);
  const auto carried = [&](const Rgb& share) { return max_component(walk.throughput * share); };
  const float again = carried(absorption.reradiation);
  if (again == 0) return false;
  const float chance = again / (again + carried(surface.base_colour));
  if (static_cast<float>(sampler.next_1d()) >= chance) {
    walk.throughput /= 1 - chance;
    return false;
  }
  walk.throughput *= absorption.reradiation / chance;
  walk.bands = absorption.bands;
  return true;
}

Rgb Path::sky(const Walk& walk) const {
  if (walk.mirrors_only) return walk.bands.emission(lights_.seen_in_sky(walk.ray.direction));  // directly or in mirrors
  const Rgb radiance = walk.bands.emission(lights_.environment().radiance(walk.ray.direction));
  if (!lights_.environment().lights_surfaces()) return Rgb(0);
  if (walk.bsdf_pdf == 0) return caustics_ ? radiance : Rgb(0);
  return radiance * static_cast<float>(
                        power_heuristic(walk.bsdf_pdf, lights_.environment_pdf(walk.ray.direction, walk.last_facing)));
}

Rgb Path::emitted(const Walk& walk, const SurfacePoint& point, const SurfaceMaterial& surface) const {
  if (is_black(surface.emission)) return Rgb(0);
  const Material& material = tracer_.scene().materials[point.material];
  if (material.unlit) return walk.mirrors_only ? surface.emission : Rgb(0);  // a picture of light, not a lamp
  if (!emits_towards(material, point.geometric_normal, -walk.ray.direction)) return Rgb(0);
  if (walk.bsdf_pdf == 0) return caustics_ || walk.mirrors_only ? surface.emission : Rgb(0);
  return surface.emission *
         static_cast<float>(power_heuristic(walk.bsdf_pdf, lights_.pdf(walk.last_position, point, walk.last_facing)));
}

Rgb Path::light_by_sampling(const Walk& walk, const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo,
                            PixelSampler& sampler, RayCounts& rays) const {
  const double u_light = sampler.next_1d();
  const auto s = lights_.sample(point, u_light, sampler.next_2d(), facing(bsdf, wo));
  if (!s) return Rgb(0);
  const Rgb f = bsdf.evaluate(wo, s->direction);
  if (is_black(f)) return Rgb(0);
  count(rays, RayPurpose::shadow, walk.depth);
  Interior inside = walk.interior;
  const bool through = dot(point.geometric_normal, wo) * dot(point.geometric_normal, s->direction) < 0;
  inside.cross(tracer_.scene(), point, s->direction, through);
  const Rgb passed = shadow_.transmittance(s->shadow_ray, inside, walk.bands);
  if (is_black(passed)) return Rgb(0);
  const double share = s->pdf > 0 ? power_heuristic(s->pdf, bsdf.pdf(wo, s->direction)) : 1;
  const double cosine = std::abs(dot(bsdf.shading_normal(), s->direction));
  return f * passed * s->weight(walk.bands) * static_cast<float>(share * cosine);
}

bool Path::goes_on(Walk& walk, PixelSampler& sampler) {
  if (++walk.depth <= sure_bounces) return true;
  const double survival = survival_chance(walk.throughput);
  if (sampler.next_1d() >= survival) return false;
  walk.throughput /= static_cast<float>(survival);
  return true;
}

bool Path::scatters_before(const std::optional<Hit>& hit, Walk& walk, PixelEstimate& seen, PixelSampler& sampler,
                           RayCounts& rays) const {
  const Media& media = shadow_.media();
  Airlight::Way way{walk.ray, walk.interior.innermost(), walk.interior, walk.bands};
  if (hit) {
    const SurfacePoint point = tracer_.surface_point(walk.ray, *hit);
    way.around = walk.interior.around(tracer_.scene(), point, dot(point.geometric_normal, walk.ray.direction) < 0);
    way.ray.t_max = hit->t;
    if (walk.depth == 0) {  // what the layers hold is what stands behind the fog
      const SurfaceMaterial surface = surface_material(tracer_.scene(), point, walk.bands);
      const Frame frame = frame_towards(surface.shading, point.geometric_normal, -walk.ray.direction);
      note_surface(seen, walk.ray, point, surface, Bsdf(surface, frame, point.geometric_normal), seen.direct);
    }
  }
  if (way.around) walk.interior.note_inside(*way.around);
  way.interior = walk.interior;
  if (!media.scattering_interval(way.around, way.ray)) {
    walk.throughput *= media.transmittance(way.around, way.ray, walk.bands);
    return false;
  }
  const bool is_last = max_depth_ > 0 && walk.depth >= max_depth_;
  Rgb light(0);
  std::optional<Airlight::Anchor> anchor;
  if (!is_last && walk.depth < equiangular_bounces) anchor = airlight_.choose_anchor(way, sampler.next_1d());
  if (anchor) light += walk.throughput * airlight_.by_angles(way, *anchor, walk.throughput, walk.depth, sampler, rays);

  CounterRng steps(std::bit_cast<std::uint64_t>(sampler.next_1d()));
  const Media::Flight flight = media.fly(way.around, way.ray, walk.throughput, sampler.next_2d(), steps, walk.bands);
  if (flight.collided && !is_last) {
    const Rgb arriving = walk.throughput * flight.weight;
    light += arriving * airlight_.at_collision(way, flight, anchor, walk.throughput, walk.depth, sampler, rays);
  }
  if (walk.depth == 0) seen.direct += light;
  seen.radiance += light;
  walk.throughput *= is_last && flight.collided ? Rgb(0) : flight.weight;
  if (!flight.collided) return false;
  scatter(flight, walk, sampler);
  return true;
}

void Path::scatter(const Media::Flight& flight, Walk& walk, PixelSampler& sampler) const {
  const HenyeyGreenstein phase(tracer_.scene().media[flight.medium].asymmetry);
  const Vec3d forward = walk.ray.direction;
  walk.ray = {.origin = walk.ray.at(flight.distance),
              .direction = phase.sample(forward, sampler.next_2d()),
              .time = walk.ray.time};
  walk.differential.reset();
  walk.bsdf_pdf = phase.value(dot(forward, walk.ray.direction));
  walk.start = walk.last_position = walk.ray.origin;
  walk.last_facing = Vec3d(0);
  walk.mirrors_only = false;
}

// Chooses where the path goes on; false when it ends.
bool Path::bounce(Walk& walk, const SurfacePoint& point, const SurfaceMaterial& surface, const Bsdf& bsdf,
                  PixelSampler& sampler, RayCounts& rays) const {
  const double u_lobe = sampler.next_1d();
  const auto s = bsdf.sample(-walk.ray.direction, u_lobe, sampler.next_2d());
  if (!s) return false;
  walk.throughput *= s->weight;
  if (is_black(walk.throughput) || !goes_on(walk, sampler)) return false;
  walk.bsdf_pdf = s->pdf;
  walk.start = walk.last_position = point.position;
  walk.last_facing = facing(bsdf, -walk.ray.direction);
  walk.mirrors_only = walk.mirrors_only && s->ideal;
  walk.interior.cross(tracer_.scene(), point, s->direction, s->transmitted);
  turn_differential(walk, point, surface, bsdf, *s);
  walk.ray = leave(point, s->direction);
  count(rays,
        !s->ideal        ? RayPurpose::diffuse
        : s->transmitted ? RayPurpose::refraction
                         : RayPurpose::reflection,
        walk.depth);
  return true;
}

}  // namespace

std::unique_ptr<Integrator> make_path(const RayTracer& tracer, const CameraRays& camera, const RenderOptions& options) {
  return std::make_unique<Path>(tracer, camera, options);
}

}  // namespace penumbra
