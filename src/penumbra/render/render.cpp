#include "penumbra/render/render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/active_blocks.h"
#include "penumbra/render/integrator.h"
#include "penumbra/render/light_tracing.h"
#include "penumbra/render/radiosity_view.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/two_pass.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int tile_side = 32;                   // pixels; a task
constexpr int block_side = ActiveBlocks::side;  // pixels; a packet of rays
constexpr int blocks_a_tile = (tile_side / block_side) * (tile_side / block_side);
constexpr int most_samples_a_pass = 16;
constexpr int samples_before_rest = 16;  // of a pixel, before its noise is believed

void check(const RenderOptions& o) {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(what);
  };
  require(o.width >= 1 && o.height >= 1 && o.width <= max_render_side && o.height <= max_render_side,
          "a picture's width and height must be 1 to 32768 pixels");
  require(o.samples_per_pixel >= 1 && o.samples_per_pixel <= 1 << 24, "samples per pixel must be 1 to 16777216");
  require(o.max_depth >= 0, "the depth must not be negative");
  require(o.min_throughput >= 0 && o.min_throughput <= 1, "the smallest throughput must lie in 0 to 1");
  require(o.noise >= 0 && o.noise < 1, "the noise target must lie in 0 to 1");
  require(o.shadow_samples >= 0 && o.shadow_samples <= 1 << 16, "shadow rays to a lamp must be 0 to 65536");
  require(o.final_gather >= 0, "the rays that gather light must not be fewer than 0");
  require(!o.spectral || o.integrator == IntegratorKind::path || o.integrator == IntegratorKind::whitted,
          "wavelengths are followed by the integrators path and whitted only");
  require(o.time_limit >= 0, "the time limit must not be negative");
  if (o.region) {
    const Region& r = *o.region;
    require(0 <= r.x0 && r.x0 < r.x1 && r.x1 <= o.width && 0 <= r.y0 && r.y0 < r.y1 && r.y1 <= o.height,
            "the region must lie in the picture and hold at least one pixel");
  }
}

void refuse_media(const RayTracer& tracer, const char* integrator) {
  if (Media(tracer.scene()).none()) return;
  throw std::invalid_argument(std::string(integrator) +
                              " knows no fog, smoke or other media; render with whitted or path");
}

// Coefficients of media are red, green and blue.
void refuse_media_for_wavelengths(const RayTracer& tracer) {
  if (Media(tracer.scene()).none()) return;
  throw std::invalid_argument(
      "wavelengths are not followed through fog, smoke and other media; leave one of them away");
}

std::unique_ptr<Integrator> make_integrator(const RayTracer& tracer, const CameraRays& camera,
                                            const RenderOptions& options) {
  if (options.spectral) refuse_media_for_wavelengths(tracer);
  switch (options.integrator) {
    case IntegratorKind::appel:
      refuse_media(tracer, "appel");
      return make_appel(tracer, camera, options);
    case IntegratorKind::whitted:
      return make_whitted(tracer, camera, options);
    case IntegratorKind::path:
      return make_path(tracer, camera, options);
    case IntegratorKind::light:
      break;  // not from the eye
  }
  throw std::invalid_argument("unknown integrator");
}

// Samples are taken in passes over the whole picture, so that a render cut short is a whole, noisier picture. The
// passes double from one sample; they do not depend on time, so neither do the sums.
std::vector<int> pass_ends(int samples) {
  std::vector<int> ends;
  for (int done = 0; done < samples;) {
    done = std::min(samples, done + std::clamp(done, 1, most_samples_a_pass));
    ends.push_back(done);
  }
  return ends;
}

// The work of one render: tiles of every pass, shared by all threads.
class Job {
 public:
  Job(const Integrator& integrator, const RenderOptions& options, const Progress& progress)
      : integrator_(integrator),
        options_(options),
        progress_(progress),
        region_(options.region.value_or(Region{0, 0, options.width, options.height})),
        columns_((region_.x1 - region_.x0 + tile_side - 1) / tile_side),
        rows_((region_.y1 - region_.y0 + tile_side - 1) / tile_side),
        counts_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
        blocks_(region_, options.noise),
        began_(Clock::now()) {}

  /// Draws into `result`: the picture, its mean samples, and whether it was cut short.
  void run(RenderResult& result) {
    const bool one_pass = pass_ends(options_.samples_per_pixel).size() == 1;
    const std::uint64_t samples = one_pass ? run_once(result.image) : run_passes(result.image);
    result.partial = cut_.load();
    result.rays = total();
    result.mean_samples =
        static_cast<double>(samples) / (static_cast<double>(region_.x1 - region_.x0) * (region_.y1 - region_.y0));
  }

 private:
  // One pass needs no sums from before: each tile is drawn on a film of its own and developed while it is in the
  // processor's cache. Returns the samples taken.
  std::uint64_t run_once(Image& image) {
    image = Image(options_.width, options_.height, picture_channels(options_.aovs));
    std::atomic<std::uint64_t> samples{0};
    parallel_for(counts_.size(), 1, [&](std::size_t tile, std::size_t) {
      if (cut_short()) return;
      Film film(tile_area(tile), options_.aovs);
      tell(render_tile(tile, 0, options_.samples_per_pixel, film) *
           static_cast<std::size_t>(options_.samples_per_pixel));
      film.develop_into(image);
      samples += film.sample_count();
    });
    return samples;
  }

  std::uint64_t run_passes(Image& image) {
    Film film(options_.width, options_.height, options_.aovs, options_.noise > 0);
    pass_after_pass(film);
    image = film.develop();
    return film.sample_count();
  }

  void pass_after_pass(Film& film) {
    int first = 0;
    for (const int last : pass_ends(options_.samples_per_pixel)) {
      parallel_for(counts_.size(), 1, [&](std::size_t tile, std::size_t) {
        if (cut_short()) return;
        const std::size_t blocks = render_tile(tile, first, last, film);
        tell(blocks * static_cast<std::size_t>(last - first));
      });
      if (cut_.load()) return;
      first = last;
      if (options_.noise > 0 && last >= samples_before_rest) {
        const std::size_t active = blocks_.active_count();
        blocks_.update(film);
        // What rests will get no more.
        tell((active - blocks_.active_count()) * static_cast<std::size_t>(options_.samples_per_pixel - last));
        if (blocks_.active_count() == 0) break;
      }
    }
  }

  [[nodiscard]] RayCounts total() const {
    RayCounts sum;
    for (const RayCounts& c : counts_) sum += c;
    return sum;
  }

  bool cut_short() {
    if (cut_.load(std::memory_order_relaxed)) return true;
    const bool late =
        options_.time_limit > 0 && std::chrono::duration<double>(Clock::now() - began_).count() > options_.time_limit;
    if (late || progress_.stop_requested()) cut_.store(true);
    return late || progress_.stop_requested();
  }

  [[nodiscard]] Region tile_area(std::size_t tile) const {
    const int x0 = region_.x0 + static_cast<int>(tile) % columns_ * tile_side;
    const int y0 = region_.y0 + static_cast<int>(tile) / columns_ * tile_side;
    return {x0, y0, std::min(region_.x1, x0 + tile_side), std::min(region_.y1, y0 + tile_side)};
  }

  /// Returns the number of blocks that were not at rest.
  std::size_t render_tile(std::size_t tile, int first, int last, Film& film) {
    const Region area = tile_area(tile);
    std::vector<PixelBlock> blocks;
    blocks.reserve(static_cast<std::size_t>(blocks_a_tile));
    for (int y = area.y0; y < area.y1; y += block_side) {
      for (int x = area.x0; x < area.x1; x += block_side) {
        if (!blocks_.is_active((x - region_.x0) / block_side, (y - region_.y0) / block_side)) continue;
        blocks.push_back({x, y, std::min(area.x1, x + block_side), std::min(area.y1, y + block_side), first, last});
      }
    }
    integrator_.render(blocks, film, counts_[tile]);
    return blocks.size();
  }

  void tell(std::size_t block_samples) {
    if (!progress_.report) return;
    const double all = static_cast<double>(blocks_.block_count()) * options_.samples_per_pixel;
    const std::scoped_lock lock(telling_);
    done_ += block_samples;
    progress_.tell("render", std::min(1.0, static_cast<double>(done_) / all));
  }

  const Integrator& integrator_;
  const RenderOptions& options_;
  const Progress& progress_;
  Region region_;
  int columns_, rows_;
  std::vector<RayCounts> counts_;  // by tile
  ActiveBlocks blocks_;
  Clock::time_point began_;
  std::atomic<bool> cut_{false};
  std::mutex telling_;
  std::size_t done_ = 0;  // blocks x samples
};

/// Shows a radiosity solution.
class RadiosityIntegrator final : public RayIntegrator {
 public:
  RadiosityIntegrator(const RadiosityView& view, const CameraRays& camera, std::uint64_t seed)
      : RayIntegrator(camera, seed), view_(view) {}

  [[nodiscard]] PixelEstimate estimate(const Ray& ray, PixelSampler&, RayCounts& rays) const override {
    count(rays, RayPurpose::primary, 0);
    const RadiosityView::Sight sight = view_.look(ray);
    PixelEstimate seen;
    seen.radiance = sight.radiance;
    seen.direct = sight.hit ? sight.emission : sight.radiance;
    seen.albedo = sight.albedo;
    seen.normal = sight.hit ? Vec3f(sight.normal) : Vec3f(0);
    seen.position = Vec3f(sight.position);
    seen.depth = sight.hit ? static_cast<float>(sight.distance) : std::numeric_limits<float>::infinity();
    seen.object = sight.hit ? static_cast<float>(sight.object) : -1.0F;
    seen.rays = 1;
    return seen;
  }

 private:
  const RadiosityView& view_;
};

RenderResult draw(const Integrator& integrator, const RenderOptions& options, const Progress& progress,
                  Clock::time_point began) {
  RenderResult result;
  Job(integrator, options, progress).run(result);
  result.rays += integrator.first_pass();
  result.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return result;
}

}  // namespace

RenderResult render(const RayTracer& tracer, const Camera& camera, const RenderOptions& options,
                    const Progress& progress) {
  check(options);
  const bool moves = tracer.has_motion() || !camera.motion.empty();
  if (moves && options.integrator == IntegratorKind::light) {
    throw std::invalid_argument("light from the lamps is traced through things at rest, and some move");
  }
  if (tracer.has_motion() && options.exact_shadows) {
    throw std::invalid_argument("exact shadows are those of things at rest, and some move while the shutter is open");
  }
  if (options.integrator == IntegratorKind::light) {
    return trace_light(tracer, camera, options, progress);
  }
  const auto began = Clock::now();
  const CameraRays rays(camera, options.width, options.height, options.filter, options.samples_per_pixel,
                        tracer.has_motion());
  return draw(*make_integrator(tracer, rays, options), options, progress, began);
}

RenderResult render(const RadiosityView& view, const Camera& camera, const RenderOptions& options,
                    const Progress& progress) {
  check(options);
  const auto began = Clock::now();
  const CameraRays rays(camera, options.width, options.height, options.filter, options.samples_per_pixel);
  return draw(RadiosityIntegrator(view, rays, options.seed), options, progress, began);
}

RenderResult render(const RayTracer& tracer, const DiffuseLight& light, const Camera& camera,
                    const RenderOptions& options, const Progress& progress) {
  check(options);
  refuse_media(tracer, "two-pass");
  const auto began = Clock::now();
  const CameraRays rays(camera, options.width, options.height, options.filter, options.samples_per_pixel);
  return draw(*make_two_pass(tracer, light, rays, options), options, progress, began);
}

}  // namespace penumbra
