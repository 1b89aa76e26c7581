// What does a spectral picture cost beside the RGB one, at equal noise?
//
// cornell-box by path tracing with and without wavelengths: CPU time, and the variance of a pixel's mean over several
// seeds, the sum over red, green and blue and over all pixels. To halve a variance takes twice the samples, so the cost
// at equal noise is time x variance; the ratio of the two is what wavelengths cost.
//
//   bench_spectral [--json FILE] [--quick]

#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench_arguments.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/render.h"
#include "penumbra/scene/builtin_scenes.h"

namespace {

using namespace penumbra;

struct Cost {
  double seconds = 0;   // CPU, of a picture
  double variance = 0;  // summed over the picture
  double luminance_variance = 0;
};

Cost measure(const RayTracer& tracer, const Camera& camera, RenderOptions options, int seeds) {
  std::vector<Image> pictures;
  const std::clock_t began = std::clock();
  for (int seed = 0; seed < seeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    pictures.push_back(render(tracer, camera, options).image);
  }
  Cost cost;
  cost.seconds = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC / seeds;
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      Vec3d sum(0), squares(0);
      double bright = 0, bright_squares = 0;
      for (const Image& picture : pictures) {
        const Vec3d c = Vec3d(picture.rgb(x, y));
        const double l = luminance(Rgb(c));
        sum += c, squares += c * c, bright += l, bright_squares += l * l;
      }
      const Vec3d variance = (squares - sum * sum / double(seeds)) / double(seeds - 1);
      cost.variance += variance.x + variance.y + variance.z;
      cost.luminance_variance += (bright_squares - bright * bright / seeds) / (seeds - 1);
    }
  }
  return cost;
}

}  // namespace

int main(int count, char** values) {
  bench::BenchArguments arguments;
  arguments.parse(count, values);
  const Scene scene = make_builtin_scene("cornell-box");
  const RayTracer tracer(scene);
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = arguments.quick ? 64 : 128;
  nlohmann::json out;
  fmt::print("cornell-box, path, {} x {}; one thread's CPU time\n\n{:>8} {:>10} {:>10} {:>10} {:>12} {:>12}\n",
             options.width, options.height, "samples", "RGB s", "spectral s", "time x", "variance x", "cost x");
  const ThreadLimit limit(1);
  for (const int samples : {16, 64}) {
    options.samples_per_pixel = samples;
    const int seeds = arguments.quick ? 4 : 16;
    options.spectral = false;
    const Cost rgb = measure(tracer, scene.cameras[0], options, seeds);
    options.spectral = true;
    const Cost spectral = measure(tracer, scene.cameras[0], options, seeds);
    const double time = spectral.seconds / rgb.seconds, variance = spectral.variance / rgb.variance;
    fmt::print("{:8} {:10.3f} {:10.3f} {:10.3f} {:12.3f} {:12.3f}\n", samples, rgb.seconds, spectral.seconds, time,
               variance, time * variance);
    out["cornell_box"].push_back({{"samples", samples},
                                  {"seeds", seeds},
                                  {"rgb_cpu_seconds", rgb.seconds},
                                  {"spectral_cpu_seconds", spectral.seconds},
                                  {"time_ratio", time},
                                  {"variance_ratio", variance},
                                  {"luminance_variance_ratio", spectral.luminance_variance / rgb.luminance_variance},
                                  {"cost_at_equal_noise", time * variance}});
  }
  if (!arguments.json.empty()) std::ofstream(arguments.json) << out.dump(2) << '\n';
  return 0;
}
