#include "penumbra/baking/final_gather.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <unordered_map>

#include "penumbra/math/rng.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr int lanes = Outlook::lanes;
/// Charts with fewer texels are judged together.
constexpr std::uint32_t fewest_texels = 64;
/// A surface darker than this share of the scene's mean need not be better than if it had it.
constexpr double darkest = 0.05;

/// Sixteen texels on their way to the noise aimed at.
class Group {
 public:
  Group(const TexelRays& rays, const LightCells& cells, std::span<const std::uint32_t> texels,
        const FinalGatherOptions& options)
      : rays_(rays), cells_(cells), texels_(texels), key_(hash_key(options.seed, 4, texels[0])), outlook_(key_) {
    for (std::size_t lane = 0; lane < texels.size(); ++lane) {
      if (cells.is_buried(texels[lane])) continue;
      const Place place = rays.points()[texels[lane]];
      outlook_.set(static_cast<int>(lane), rays.points().lifted(place), place.shading, place.normal,
                   hash_key(options.seed, 5, texels[lane]));
      ++used_;
    }
  }

  [[nodiscard]] int used() const { return used_; }

  /// Rays [first, last) of every texel.
  void trace(std::uint32_t first, std::uint32_t last) {
    std::array<Rgb, lanes> sums{};
    RayPacket packet;
    Landing landings[lanes];
    for (std::uint32_t k = first; k < last; ++k) {
      outlook_.rays(k, packet);
      rays_.trace(packet, hash_key(key_, k), landings);
      for (std::size_t i = 0; i < texels_.size(); ++i) {
        const Landing& l = landings[i];
        Rgb light = l.extra;
        if (l.side != Landing::nowhere) light += l.weight * Rgb(cells_.radiosity(l.side));
        sums[i] += light;
      }
    }
    // The sums so far and these are the two half sets.
    const auto half = static_cast<float>(last - first);
    for (std::size_t i = 0; i < texels_.size(); ++i) {
      const Rgb mean = sums[i] / half;
      difference_[i] = first == 0 ? 0 : std::abs(luminance(mean - mean_[i]));
      mean_[i] = first == 0 ? mean : 0.5F * (mean_[i] + mean);
    }
  }
  [[nodiscard]] const Rgb& mean(std::size_t lane) const { return mean_[lane]; }
  /// Standard error by the half sets' difference.
  [[nodiscard]] float error(std::size_t lane) const { return 0.5F * difference_[lane]; }

 private:
  const TexelRays& rays_;
  const LightCells& cells_;
  std::span<const std::uint32_t> texels_;
  std::uint64_t key_;
  Outlook outlook_;
  int used_ = 0;
  std::array<Rgb, lanes> mean_{};
  std::array<float, lanes> difference_{};
};

}  // namespace

NoiseSurfaces make_noise_surfaces(const TexelMap& map, const LightCells& cells) {
  const std::size_t charts = map.atlas().charts.size(), count = map.texels().count();
  std::vector<std::uint32_t> texels(charts, 0);
  for (std::uint32_t t = 0; t < count; ++t) ++texels[map.chart(t)];
  NoiseSurfaces surfaces;
  surfaces.of_chart.resize(charts);
  std::unordered_map<std::uint32_t, std::uint32_t> of_instance;
  std::uint32_t next = 0;
  for (std::size_t c = 0; c < charts; ++c) {
    if (texels[c] >= fewest_texels) {
      surfaces.of_chart[c] = next++;
      continue;
    }
    const auto [at, is_new] = of_instance.try_emplace(map.atlas().charts[c].object, next);
    if (is_new) ++next;
    surfaces.of_chart[c] = at->second;
  }
  surfaces.mean.assign(next, 0);
  std::vector<double> counts(next, 0);
  double free = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    if (cells.is_buried(t)) continue;
    const std::uint32_t s = surfaces.of_chart[map.chart(t)];
    const double light = luminance(cells.irradiance(t));
    surfaces.mean[s] += light, counts[s] += 1;
    surfaces.scene_mean += light, free += 1;
  }
  for (std::size_t s = 0; s < next; ++s) surfaces.mean[s] /= std::max(1.0, counts[s]);
  surfaces.scene_mean /= std::max(1.0, free);
  return surfaces;
}

GatheredLight final_gather(const TexelRays& rays, const LightCells& cells, const NoiseSurfaces& surfaces,
                           std::span<const std::uint32_t> order, const FinalGatherOptions& options,
                           const Progress& progress) {
  const std::size_t count = order.size(), groups = (count + lanes - 1) / lanes;
  GatheredLight result;
  result.irradiance.assign(3 * count, 0);
  result.error.assign(count, 0);
  std::vector<std::uint32_t> spent(groups, 0);
  const auto gather_group = [&](std::size_t g) {
    const auto texels = order.subspan(g * lanes, std::min<std::size_t>(lanes, count - g * lanes));
    Group group(rays, cells, texels, options);
    if (group.used() == 0) return;
    const std::uint32_t start = options.fewest_rays / 2;
    group.trace(0, start);
    for (std::uint32_t k = start; k < options.most_rays; k *= 2) {
      group.trace(k, 2 * k);
      spent[g] = 2 * k;
      double excess = 0;
      for (std::size_t i = 0; i < texels.size(); ++i) {
        const double mean =
            std::max(surfaces.mean[surfaces.of_chart[rays.map().chart(texels[i])]], darkest * surfaces.scene_mean);
        const double error = group.error(i) / std::max(1e-30, options.noise * mean);
        excess += error * error;
      }
      if (excess <= group.used()) break;
    }
    for (std::size_t i = 0; i < texels.size(); ++i) {
      for (int b = 0; b < 3; ++b) {
        result.irradiance[std::size_t{3} * texels[i] + static_cast<std::size_t>(b)] = group.mean(i)[b];
      }
      result.error[texels[i]] = group.error(i);
    }
    spent[g] *= static_cast<std::uint32_t>(group.used());
  };
  // In rounds, so that the caller hears of it and can stop.
  const std::size_t round = std::max<std::size_t>(64, groups / 64);
  for (std::size_t start = 0; start < groups; start += round) {
    if (progress.stop_requested()) {
      result.partial = true;
      break;
    }
    parallel_for(std::min(round, groups - start), 4, [&](std::size_t first, std::size_t last) {
      for (std::size_t g = start + first; g < start + last; ++g) gather_group(g);
    });
    progress.tell("gather", static_cast<double>(std::min(groups, start + round)) / static_cast<double>(groups));
  }
  for (const std::uint32_t s : spent) result.rays += s;
  return result;
}

}  // namespace penumbra
