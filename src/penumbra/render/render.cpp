#include "penumbra/render/render.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "penumbra/render/contrast.h"
#include "penumbra/render/light_tracing.h"
#include "penumbra/render/radiosity_view.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/render_job.h"
#include "penumbra/render/two_pass.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {
namespace {

using Clock = RenderJob::Clock;

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
  require(o.contrast >= 0 && o.contrast < 1, "the contrast must lie in 0 to 1");
  require(o.noise == 0 || o.contrast == 0, "samples follow the noise or the contrast, not both");
  require(o.shadow_samples >= 0 && o.shadow_samples <= 1 << 16, "shadow rays to a lamp must be 0 to 65536");
  require(o.final_gather >= 0, "the rays that gather light must not be fewer than 0");
  require(!o.spectral || o.integrator != IntegratorKind::appel,
          "appel follows no light that has a wavelength of its own; render with path, whitted or light");
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

std::unique_ptr<Integrator> make_integrator(const RayTracer& tracer, const CameraRays& camera,
                                            const RenderOptions& options) {
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

/// Makes the integrator of a picture.
using Maker = std::function<std::unique_ptr<Integrator>(const CameraRays& camera, const RenderOptions& options)>;

/// A picture in the making, and what it took.
class Drawing {
 public:
  Drawing(const RayTracer* tracer, const Camera& camera, Maker make, const Progress& progress)
      : moves_(tracer != nullptr && tracer->has_motion()),
        camera_(camera),
        make_(std::move(make)),
        progress_(progress),
        began_(Clock::now()) {}

  /// Takes the samples of all pixels of the region, or of the marked ones alone.
  void draw(const RenderOptions& options, const char* stage, std::vector<std::uint8_t> marks = {}) {
    const CameraRays camera(camera_, options.width, options.height, options.filter, options.samples_per_pixel, moves_);
    const auto integrator = make_(camera, options);
    RenderJob job(*integrator, options, progress_, stage, began_);
    if (!marks.empty()) job.restrict_to(std::move(marks));
    samples_ += job.run(result_);
    result_.rays += integrator->first_pass();
  }

  [[nodiscard]] Image& image() { return result_.image; }
  [[nodiscard]] bool is_cut_short() const { return result_.partial; }

  /// @param region of the picture that was asked for.
  RenderResult take(const Region& region) {
    const double pixels = static_cast<double>(region.x1 - region.x0) * (region.y1 - region.y0);
    result_.mean_samples = static_cast<double>(samples_) / pixels;
    result_.seconds = std::chrono::duration<double>(Clock::now() - began_).count();
    return std::move(result_);
  }

 private:
  bool moves_;
  const Camera& camera_;
  Maker make_;
  const Progress& progress_;
  Clock::time_point began_;
  RenderResult result_;
  std::uint64_t samples_ = 0;
};

Region region_of(const RenderOptions& options) {
  return options.region.value_or(Region{0, 0, options.width, options.height});
}

// Few samples first, and all of them where those show an edge. The first ones are not used again there: what decides is
// no part of what is decided on, so that it leaves no bias (Kirk & Arvo 1991).
RenderResult draw_by_contrast(Drawing drawing, const RenderOptions& options, int samples_first) {
  const Region region = region_of(options);
  RenderOptions first = options;
  first.samples_per_pixel = samples_first;
  first.region = Region{std::max(0, region.x0 - 1), std::max(0, region.y0 - 1), std::min(options.width, region.x1 + 1),
                        std::min(options.height, region.y1 + 1)};
  drawing.draw(first, "first samples");
  std::vector<std::uint8_t> marks = contrasted_pixels(drawing.image(), region, options.contrast);
  leave_only(region, drawing.image());
  const bool any = std::find(marks.begin(), marks.end(), 1) != marks.end();
  if (any && !drawing.is_cut_short()) drawing.draw(options, "render", std::move(marks));
  return drawing.take(region);
}

RenderResult draw(Drawing drawing, const RenderOptions& options, int samples_to_judge) {
  if (options.contrast > 0 && options.samples_per_pixel > samples_to_judge) {
    return draw_by_contrast(std::move(drawing), options, samples_to_judge);
  }
  drawing.draw(options, "render");
  return drawing.take(region_of(options));
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
  if (options.contrast > 0 && options.integrator == IntegratorKind::path) {
    throw std::invalid_argument("paths are noisy everywhere, so contrast tells nothing; give a noise target");
  }
  const auto make = [&](const CameraRays& rays, const RenderOptions& o) { return make_integrator(tracer, rays, o); };
  return draw(Drawing(&tracer, camera, make, progress), options, samples_to_judge(tracer, camera));
}

RenderResult render(const RadiosityView& view, const Camera& camera, const RenderOptions& options,
                    const Progress& progress) {
  check(options);
  const auto make = [&](const CameraRays& rays, const RenderOptions& o) {
    return std::make_unique<RadiosityIntegrator>(view, rays, o.seed);
  };
  return draw(Drawing(nullptr, camera, make, progress), options, samples_to_judge(camera));
}

RenderResult render(const RayTracer& tracer, const DiffuseLight& light, const Camera& camera,
                    const RenderOptions& options, const Progress& progress) {
  check(options);
  refuse_media(tracer, "two-pass");
  const auto make = [&](const CameraRays& rays, const RenderOptions& o) {
    return make_two_pass(tracer, light, rays, o);
  };
  return draw(Drawing(nullptr, camera, make, progress), options, samples_to_judge(tracer, camera));
}

}  // namespace penumbra
