// How long until a lightmap is right to 1 %?
//
// cornell-box with 64 x 64 texels on each of the 15 quadrilaterals beside the lamp (61,440 texels; 64 more on the
// lamp), baked to a noise aimed at, against a reference of the same texels baked with many more rays: seconds, RMS
// error relative to each surface's mean, and the worst surface. Then an atlas of 512 x 512.
//
//   bench_bake [--json FILE] [--quick] [--noise R] [--denoise]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "../tests/baking/quad_atlas.h"
#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/baking/texel_light.h"
#include "penumbra/math/spectrum.h"
#include "penumbra/scene/builtin_scenes.h"

namespace {

using namespace penumbra;

struct Clock {
  std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();
  std::clock_t cpu = std::clock();
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  }
  [[nodiscard]] double cpu_seconds() const { return static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC; }
};

struct Error {
  double rms = 0, worst = 0;
  std::string worst_surface;
};

// Of luminance, relative to each chart's mean; texels that are buried in either are left out.
Error compare(const LightmapAtlas& atlas, const Texels& texels, const TexelLight& light, const TexelLight& reference) {
  const auto value = [](const TexelLight& l, std::size_t t) {
    return static_cast<double>(luminance({l.irradiance[3 * t], l.irradiance[3 * t + 1], l.irradiance[3 * t + 2]}));
  };
  std::vector<double> squares(atlas.charts.size()), means(squares), counts(squares);
  for (std::size_t t = 0; t < texels.count(); ++t) {
    if (light.buried[t] != 0 || reference.buried[t] != 0) continue;
    const std::uint32_t c = atlas.chart_of_triangle[texels.triangles[t]];
    const double truth = value(reference, t), error = value(light, t) - truth;
    squares[c] += error * error, means[c] += truth, counts[c] += 1;
  }
  Error e;
  double all = 0, count = 0;
  for (std::size_t c = 0; c < squares.size(); ++c) {
    if (!(means[c] > 0)) continue;
    const double mean = means[c] / counts[c], square = squares[c] / (mean * mean);
    all += square, count += counts[c];
    if (std::sqrt(square / counts[c]) > e.worst) {
      e.worst = std::sqrt(square / counts[c]);
      e.worst_surface = atlas.scene.instances[atlas.charts[c].object].name;
    }
  }
  e.rms = std::sqrt(all / count);
  return e;
}

}  // namespace

int main(int count, char** words) {
  std::string json_file;
  bool quick = false, denoise = false;
  double noise = 0;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--json" && i + 1 < count) json_file = words[++i];
    if (word == "--noise" && i + 1 < count) noise = std::stod(words[++i]);
    if (word == "--quick") quick = true;
    if (word == "--denoise") denoise = true;
  }
  const Scene cornell = make_builtin_scene("cornell-box");
  std::vector<test::Quad> quads = test::quads_of(cornell, 64);
  for (test::Quad& q : quads) {
    if (q.name == "light") q.width = q.height = 8;
  }
  Scene bare = cornell;
  bare.meshes.clear(), bare.instances.clear();
  const LightmapAtlas atlas = test::quad_atlas(std::move(bare), quads);
  const Texels texels = make_texels(atlas);

  nlohmann::json out;
  TexelLightOptions fine;
  fine.seed = 1;
  fine.noise = 1e-9;
  fine.fewest_rays = fine.most_rays = quick ? 4096 : 32768;
  const Clock fine_clock;
  const TexelLight reference = bake_texel_light(atlas, texels, fine);
  fmt::print("cornell-box, {} texels; reference {} rays a texel, {:.1f} s, estimated noise {:.3f} %\n\n",
             texels.count(), fine.most_rays, fine_clock.seconds(), 100 * reference.noise);
  fmt::print("{:>9} {:>8} {:>8} {:>11} {:>8} {:>9} {:>9}  {}\n", "aimed %", "s", "CPU s", "rays/texel", "Mray/s",
             "RMS %", "worst %", "worst surface");
  std::vector<std::pair<double, bool>> runs;
  for (const double aimed : noise > 0 ? std::vector<double>{noise} : std::vector<double>{0.04, 0.02, 0.01, 0.005}) {
    runs.emplace_back(aimed, false);
    if (denoise) runs.emplace_back(aimed, true);
  }
  for (const auto& [aimed, denoised] : runs) {
    TexelLightOptions options;
    options.noise = aimed;
    options.denoise = denoised;
    const Clock clock;
    const TexelLight light = bake_texel_light(atlas, texels, options);
    const double seconds = clock.seconds(), cpu = clock.cpu_seconds();
    const Error e = compare(atlas, texels, light, reference);
    fmt::print("{:9.2f} {:8.2f} {:8.2f} {:11.0f} {:8.1f} {:9.3f} {:9.3f}  {}   (says {:.3f}, {:.3f}){}\n", 100 * aimed,
               seconds, cpu, static_cast<double>(light.rays) / static_cast<double>(texels.count()),
               static_cast<double>(light.rays) / seconds / 1e6, 100 * e.rms, 100 * e.worst, e.worst_surface,
               100 * light.noise, 100 * light.worst_noise, denoised ? "  denoised" : "");
    out["cornell_61440"].push_back({{"aimed", aimed},
                                    {"denoised", denoised},
                                    {"seconds", seconds},
                                    {"cpu_seconds", cpu},
                                    {"rays", light.rays},
                                    {"rms", e.rms},
                                    {"worst", e.worst},
                                    {"worst_surface", e.worst_surface}});
  }
  AtlasOptions packed;
  packed.size = 512;
  const LightmapAtlas square = make_lightmap_atlas(cornell, packed);
  const Texels square_texels = make_texels(square);
  const Clock clock;
  const TexelLight light = bake_texel_light(square, square_texels);
  fmt::print("\n512 x 512 ({} texels): {:.2f} s, {:.2f} CPU s, estimated noise {:.2f} %, worst surface {:.2f} %\n",
             square_texels.count(), clock.seconds(), clock.cpu_seconds(), 100 * light.noise, 100 * light.worst_noise);
  out["cornell_512"] = {{"texels", square_texels.count()},
                        {"seconds", clock.seconds()},
                        {"cpu_seconds", clock.cpu_seconds()},
                        {"estimated_noise", light.noise}};
  if (!json_file.empty()) std::ofstream(json_file) << out.dump(2) << '\n';
  return 0;
}
