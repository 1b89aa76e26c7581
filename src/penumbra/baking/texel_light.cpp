#include "penumbra/baking/texel_light.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "penumbra/baking/final_gather.h"
#include "penumbra/baking/texel_denoising.h"
#include "penumbra/baking/texel_solution.h"

namespace penumbra {
namespace {

/// Texels inside solid matter take the light of free ones of their chart at most this many away.
constexpr int farthest_fill = 8;

void check(const TexelLightOptions& options) {
  const auto is_power = [](int n) { return n > 0 && std::has_single_bit(static_cast<unsigned>(n)); };
  if (!(options.noise > 0)) throw std::invalid_argument("the noise aimed at must be above 0");
  if (!is_power(options.fewest_rays) || !is_power(options.most_rays) || options.fewest_rays < 8 ||
      options.most_rays < options.fewest_rays || options.most_rays > (1 << 20)) {
    throw std::invalid_argument("rays a texel must be powers of 2 from 8 to 1048576, the fewest first");
  }
}

/// Gives buried texels the mean of the free ones beside them, one ring after another.
void fill_buried(const TexelMap& map, TexelLight& light) {
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t t = 0; t < light.buried.size(); ++t) {
    if (light.buried[t] != 0) waiting.push_back(t);
  }
  std::vector<std::uint8_t> has_light(light.buried.size());
  for (std::size_t t = 0; t < has_light.size(); ++t) has_light[t] = light.buried[t] == 0;
  for (int ring = 0; ring < farthest_fill && !waiting.empty(); ++ring) {
    std::vector<std::uint32_t> filled, rest;
    for (const std::uint32_t t : waiting) {
      std::array<double, 6> sum{};
      double count = 0;
      for (int k = 0; k < 9; ++k) {
        const std::uint32_t other = map.beside(t, k % 3 - 1, k / 3 - 1);
        if (other == TexelMap::none || has_light[other] == 0) continue;
        for (std::size_t b = 0; b < 3; ++b) {
          sum[b] += light.irradiance[std::size_t{3} * other + b];
          sum[b + 3] += light.direct[std::size_t{3} * other + b];
        }
        count += 1;
      }
      if (count == 0) {
        rest.push_back(t);
        continue;
      }
      for (std::size_t b = 0; b < 3; ++b) {
        light.irradiance[std::size_t{3} * t + b] = static_cast<float>(sum[b] / count);
        light.direct[std::size_t{3} * t + b] = static_cast<float>(sum[b + 3] / count);
      }
      filled.push_back(t);
    }
    for (const std::uint32_t t : filled) has_light[t] = 1;
    waiting.swap(rest);
  }
}

/// The noise of each surface and of all, from the errors of texels.
void measure_noise(const TexelMap& map, const NoiseSurfaces& surfaces, TexelLight& light) {
  std::vector<double> sums(surfaces.mean.size(), 0), counts(surfaces.mean.size(), 0);
  for (std::uint32_t t = 0; t < light.error.size(); ++t) {
    if (light.buried[t] != 0) continue;
    const std::uint32_t s = surfaces.of_chart[map.chart(t)];
    sums[s] += static_cast<double>(light.error[t]) * light.error[t];
    counts[s] += 1;
  }
  double all = 0, count = 0;
  for (std::size_t s = 0; s < sums.size(); ++s) {
    if (!(surfaces.mean[s] > 0) || counts[s] == 0) continue;
    const double square = sums[s] / (surfaces.mean[s] * surfaces.mean[s]);
    light.worst_noise = std::max(light.worst_noise, std::sqrt(square / counts[s]));
    all += square, count += counts[s];
  }
  light.noise = count > 0 ? std::sqrt(all / count) : 0;
  if (!(surfaces.scene_mean > 0)) return;
  for (float& e : light.error) e = static_cast<float>(e / surfaces.scene_mean);
}

}  // namespace

TexelLight bake_texel_light(const LightmapAtlas& atlas, const Texels& texels, const TexelLightOptions& options) {
  check(options);
  if (texels.count() == 0) return {};
  TexelSolution solution(atlas, texels,
                         {.noise = options.noise,
                          .front_sides_only = options.front_sides_only,
                          .opaque_shadows = options.opaque_shadows,
                          .seed = options.seed},
                         options.progress);
  return bake_texel_light(solution, options);
}

TexelLight bake_texel_light(TexelSolution& solution, const TexelLightOptions& options) {
  check(options);
  TexelLight light;
  const TexelMap& map = solution.map();
  const LightCells& cells = solution.cells();
  const std::size_t count = map.texels().count();
  light.residuals.assign(cells.residuals().begin(), cells.residuals().end());
  light.energy = texel_energy(solution);
  const NoiseSurfaces surfaces = make_noise_surfaces(map, cells);
  GatheredLight gathered = final_gather(solution.rays(), cells, surfaces, solution.order(),
                                        {.noise = options.noise,
                                         .fewest_rays = static_cast<std::uint32_t>(options.fewest_rays),
                                         .most_rays = static_cast<std::uint32_t>(options.most_rays),
                                         .seed = options.seed},
                                        options.progress);
  light.rays = cells.rays_traced() + gathered.rays;
  light.partial = solution.is_partial() || gathered.partial;
  light.buried.resize(count);
  for (std::uint32_t t = 0; t < count; ++t) light.buried[t] = cells.is_buried(t);
  if (options.denoise) denoise_texels(solution.points(), light.buried, gathered.irradiance, gathered.error);
  light.direct = std::move(solution.direct());
  light.irradiance = std::move(gathered.irradiance);
  for (std::size_t k = 0; k < 3 * count; ++k) light.irradiance[k] += light.direct[k];
  light.error = std::move(gathered.error);
  measure_noise(map, surfaces, light);
  fill_buried(map, light);
  return light;
}

}  // namespace penumbra
