#include "penumbra/render/light_tracing.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/eye_projection.h"
#include "penumbra/render/pixel_sampler.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/spectral_sample.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/interior.h"
#include "penumbra/tracing/shading/light_emission.h"
#include "penumbra/tracing/shading/media.h"
#include "penumbra/tracing/shading/shadow.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t particles_a_batch = 4096;
constexpr std::size_t most_batches_a_round = 64;
constexpr int sure_bounces = 3;  // before Russian roulette
constexpr double most_survival = 0.95;
constexpr std::uint64_t own_numbers = 0x6c69676874;  // a key apart from those of pixels

/// Light that arrives at a pixel.
struct Mark {
  std::uint32_t pixel;
  Rgb radiance;  // linear Rec. 709, times the number of particles
};

/// What a batch of particles brought.
struct Batch {
  std::vector<Mark> marks;
  RayCounts rays;
  ParticleFates fates;
};

/// Follows particles from the lamps.
class LightTracer {
 public:
  LightTracer(const RayTracer& tracer, const Camera& camera, const RenderOptions& options)
      : tracer_(tracer),
        options_(options),
        region_(options.region.value_or(Region{0, 0, options.width, options.height})),
        eye_(camera, options.width, options.height),
        lights_(tracer.scene()),
        emission_(tracer.scene(), lights_),
        shadow_(tracer, false) {}

  void follow(std::size_t batch, std::size_t count, Batch& out) const {
    for (std::size_t k = 0; k < count && !emission_.empty(); ++k) {
      PixelSampler sampler(hash_key(options_.seed, own_numbers, batch), 0, 0, static_cast<int>(k));
      follow(sampler, out);
    }
  }

 private:
  // A particle on its way.
  struct Walk {
    Ray ray;
    Vec3d start{0};  // the point that the ray leaves; it starts a rounding error beside it
    Bands bands;     // what the components of its power stand for
    Rgb power{0};    // W, of wavelengths W/nm
    float first_power = 0;
    int depth = 0;  // surfaces met so far
    double range = 0;
    Interior interior;
    bool met_eye = false;
    bool seen = false;
  };

  void follow(PixelSampler& sampler, Batch& out) const;
  void walk_on(Walk& walk, PixelSampler& sampler, Batch& out) const;
  [[nodiscard]] bool meets_eye(const Ray& ray, double distance) const;
  void show_lamp(const LightEmission::Origin& origin, const Bands& bands, Batch& out) const;
  [[nodiscard]] bool show_surface(const Walk& walk, const SurfacePoint& point, const Bsdf& bsdf, Batch& out) const;
  bool show(const Rgb& intensity, const Bands& bands, const Vec3d& to_eye, const Ray& way, int depth, double geometry,
            Batch& out) const;
  [[nodiscard]] bool bounce(Walk& walk, const SurfacePoint& point, const Bsdf& bsdf, PixelSampler& sampler,
                            Batch& out) const;

  const RayTracer& tracer_;
  const RenderOptions& options_;
  Region region_;
  EyeProjection eye_;
  LightSampler lights_;
  LightEmission emission_;
  Shadow shadow_;
};

void LightTracer::follow(PixelSampler& sampler, Batch& out) const {
  ++out.fates.shot;
  Walk walk;
  walk.bands = sample_bands(options_.spectral, sampler);
  const double u_light = sampler.next_1d();
  const auto origin = emission_.sample_origin(u_light, sampler.next_2d());
  if (!origin) return;
  show_lamp(*origin, walk.bands, out);
  const double u_side = sampler.next_1d();
  const LightEmission::Particle particle = emission_.sample_direction(*origin, u_side, sampler.next_2d());
  walk.ray = particle.ray;
  walk.start = particle.ray.origin;
  walk.power = walk.bands.emission(particle.power);
  walk.first_power = max_component(walk.power);
  walk.range = particle.range;
  if (!is_black(walk.power)) walk_on(walk, sampler, out);
  out.fates.met_eye += walk.met_eye ? 1 : 0;
  out.fates.seen += walk.seen ? 1 : 0;
}

void LightTracer::walk_on(Walk& walk, PixelSampler& sampler, Batch& out) const {
  const Scene& scene = tracer_.scene();
  count(out.rays, RayPurpose::primary, 0);
  while (true) {
    const auto hit = tracer_.nearest(walk.ray);
    const double distance = hit ? hit->t : std::numeric_limits<double>::infinity();
    walk.met_eye = walk.met_eye || meets_eye(walk.ray, distance);
    if (!hit) return;
    const SurfacePoint point = tracer_.surface_point(walk.ray, *hit);
    const Vec3d back = -walk.ray.direction;
    const bool front = dot(point.geometric_normal, back) > 0;
    const double travelled = length(point.position - walk.start);
    walk.power *= walk.interior.transmittance(scene, point, front, travelled, walk.bands);
    if (walk.range > 0) walk.power *= static_cast<float>(range_window(travelled, walk.range));
    if (options_.front_sides_only && !front && scene.materials[point.material].transmission == 0) return;

    const SurfaceMaterial surface = surface_material(scene, point, walk.bands);
    if (surface.alpha < 1 && sampler.next_1d() >= surface.alpha) {
      count(out.rays, RayPurpose::refraction, walk.depth);
      walk.start = point.position;
      walk.ray = leave(point, walk.ray.direction);
      continue;
    }
    if (walk.bands.spectral() && disperses(scene.materials[point.material])) leave_hero_alone(walk.power);
    walk.range = 0;
    ++walk.depth;
    const Bsdf bsdf(surface, frame_towards(surface.shading, point.geometric_normal, back), point.geometric_normal);
    if (options_.max_depth > 0 && walk.depth > options_.max_depth) return;
    if (bsdf.has_spread() && show_surface(walk, point, bsdf, out)) walk.seen = true;
    if (!bounce(walk, point, bsdf, sampler, out)) return;
  }
}

// Through the picture's frame and into the pupil, without help.
bool LightTracer::meets_eye(const Ray& ray, double distance) const {
  const double towards = -dot(ray.direction, eye_.forward());
  if (!(towards > 0)) return false;
  const double t = dot(ray.origin - eye_.eye(), eye_.forward()) / towards;
  if (!(t > 0 && t < distance)) return false;
  return length(ray.at(t) - eye_.eye()) < ParticleFates::pupil_radius && eye_.place(-ray.direction).has_value();
}

// The lamp itself, as the eye sees it.
void LightTracer::show_lamp(const LightEmission::Origin& origin, const Bands& bands, Batch& out) const {
  const Rgb light = static_cast<float>(origin.inverse_chance) * bands.emission(origin.radiance);
  if (!origin.point) {
    if (is_black(origin.radiance)) return;
    const Ray way{.origin = eye_.eye(), .direction = origin.direction};
    show(light, bands, -origin.direction, way, 0, 1, out);
    return;
  }
  const SurfacePoint& point = *origin.point;
  const Vec3d way = eye_.eye() - point.position;
  const double distance = length(way);
  if (!(distance > 0)) return;
  const Vec3d to_eye = way / distance;
  const double cosine = dot(point.geometric_normal, to_eye);
  if (!emits_towards(tracer_.scene().materials[point.material], point.geometric_normal, to_eye)) return;
  show(light, bands, to_eye, segment(point, eye_.eye()), 0, std::abs(cosine) / (distance * distance), out);
}

// What a surface sends to the eye of a particle's light. Interpolated normals weigh light by their own cosine where it
// comes in when it is followed from the eye; here that is made up for (Veach 1997, 5.3).
bool LightTracer::show_surface(const Walk& walk, const SurfacePoint& point, const Bsdf& bsdf, Batch& out) const {
  const Vec3d way = eye_.eye() - point.position;
  const double distance = length(way);
  if (!(distance > 0)) return false;
  const Vec3d to_eye = way / distance;
  const Vec3d back = -walk.ray.direction;
  const Rgb f = bsdf.evaluate(back, to_eye);
  if (is_black(f)) return false;
  const double in = std::abs(dot(back, bsdf.shading_normal())) / std::abs(dot(back, point.geometric_normal));
  const double out_cosine = std::abs(dot(to_eye, point.geometric_normal));
  return show(f * walk.power, walk.bands, to_eye, segment(point, eye_.eye()), walk.depth,
              in * out_cosine / (distance * distance), out);
}

/// Marks the pixel where the eye sees what comes along `to_eye`, unless something stands in the way.
bool LightTracer::show(const Rgb& intensity, const Bands& bands, const Vec3d& to_eye, const Ray& way, int depth,
                       double geometry, Batch& out) const {
  const auto place = eye_.place(-to_eye);
  if (!place) return false;
  if (place->x < region_.x0 || place->x >= region_.x1 || place->y < region_.y0 || place->y >= region_.y1) return false;
  count(out.rays, RayPurpose::shadow, depth);
  const Rgb passed = shadow_.transmittance(way, {}, bands);
  if (is_black(passed)) return false;
  const auto pixel = static_cast<std::uint32_t>(place->y) * static_cast<std::uint32_t>(options_.width) +
                     static_cast<std::uint32_t>(place->x);
  out.marks.push_back({pixel, bands.to_rgb(intensity * passed) * static_cast<float>(geometry * place->importance)});
  return true;
}

// Chooses where the particle goes on; false when it is absorbed.
bool LightTracer::bounce(Walk& walk, const SurfacePoint& point, const Bsdf& bsdf, PixelSampler& sampler,
                         Batch& out) const {
  const Vec3d back = -walk.ray.direction;
  const double u_lobe = sampler.next_1d();
  const auto s = bsdf.sample(back, u_lobe, sampler.next_2d());
  if (!s) return false;
  const Vec3d& n = bsdf.shading_normal();
  const Vec3d& g = point.geometric_normal;
  const double turned = std::abs(dot(back, n) * dot(s->direction, g)) / std::abs(dot(back, g) * dot(s->direction, n));
  walk.power *= s->weight * static_cast<float>(turned);
  if (is_black(walk.power)) return false;
  if (walk.depth > sure_bounces) {
    const double survival = std::min(most_survival, static_cast<double>(max_component(walk.power) / walk.first_power));
    if (sampler.next_1d() >= survival) return false;
    walk.power /= static_cast<float>(survival);
  }
  walk.start = point.position;
  walk.interior.cross(tracer_.scene(), point, s->direction, s->transmitted);
  walk.ray = leave(point, s->direction);
  count(out.rays,
        !s->ideal        ? RayPurpose::diffuse
        : s->transmitted ? RayPurpose::refraction
                         : RayPurpose::reflection,
        walk.depth);
  return true;
}

// Particles are drawn by the colours of their lamps, and dyes would send them on at other wavelengths.
void refuse_spectra(const Scene& scene) {
  for (const Material& m : scene.materials) {
    if (!m.fluorescence && !m.emission_spectrum) continue;
    throw std::invalid_argument(
        "'" + m.name + "' is " + (m.fluorescence ? "a dye" : "a lamp with a spectrum") +
        ", which particles from the lights do not know; trace wavelengths from the eye, by path");
  }
}

/// Sums of marks, pixel by pixel.
class MarkSums {
 public:
  MarkSums(int width, int height) : width_(width), height_(height), sums_(3 * size()) {}

  void add(const Batch& batch) {
    for (const Mark& mark : batch.marks) {
      for (int band = 0; band < 3; ++band) {
        sums_[std::size_t{3} * mark.pixel + static_cast<std::size_t>(band)] += mark.radiance[band];
      }
    }
  }
  [[nodiscard]] Image develop(std::uint64_t particles) const {
    Image image(width_, height_, {"R", "G", "B"});
    for (std::size_t i = 0; i < sums_.size() && particles > 0; ++i) {
      image.data[i] = static_cast<float>(sums_[i] / static_cast<double>(particles));
    }
    return image;
  }

 private:
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  int width_, height_;
  std::vector<double> sums_;
};

}  // namespace

RenderResult trace_light(const RayTracer& tracer, const Camera& camera, const RenderOptions& options,
                         const Progress& progress) {
  const auto began = Clock::now();
  if (!Media(tracer.scene()).none()) {
    throw std::invalid_argument(
        "fog and other media are not followed from the lights; leave them away, or trace from the eye");
  }
  if (options.spectral) refuse_spectra(tracer.scene());
  const LightTracer light(tracer, camera, options);
  const auto pixels = static_cast<std::uint64_t>(options.width) * static_cast<std::uint64_t>(options.height);
  const std::uint64_t all = pixels * static_cast<std::uint64_t>(options.samples_per_pixel);
  const auto late = [&] {
    return progress.stop_requested() ||
           (options.time_limit > 0 && std::chrono::duration<double>(Clock::now() - began).count() > options.time_limit);
  };
  MarkSums sums(options.width, options.height);
  RenderResult result;
  ParticleFates fates;
  // Rounds grow, so that a stop finds something done.
  std::size_t first_batch = 0;
  for (std::size_t round = 4; fates.shot < all && !result.partial; round = std::min(2 * round, most_batches_a_round)) {
    const std::uint64_t left = all - fates.shot;
    const std::size_t count = std::min<std::size_t>(round, (left + particles_a_batch - 1) / particles_a_batch);
    std::vector<Batch> batches(count);
    std::atomic<bool> cut{false};
    parallel_for(count, 1, [&](std::size_t k, std::size_t) {
      if (cut.load(std::memory_order_relaxed) || late()) {
        cut.store(true);
        return;
      }
      light.follow(first_batch + k, std::min<std::uint64_t>(particles_a_batch, left - k * particles_a_batch),
                   batches[k]);
    });
    result.partial = cut.load();
    if (result.partial) break;  // of a round cut short nothing counts: its batches are not all there
    for (const Batch& batch : batches) {
      sums.add(batch);
      result.rays += batch.rays;
      fates.shot += batch.fates.shot;
      fates.met_eye += batch.fates.met_eye;
      fates.seen += batch.fates.seen;
    }
    if (fates.shot == 0) break;  // no light
    first_batch += count;
    progress.tell("render", static_cast<double>(fates.shot) / static_cast<double>(all));
  }
  result.image = sums.develop(fates.shot);
  result.mean_samples = static_cast<double>(fates.shot) / static_cast<double>(pixels);
  result.particles = fates;
  result.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return result;
}

}  // namespace penumbra
