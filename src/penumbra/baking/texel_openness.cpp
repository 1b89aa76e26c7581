#include "penumbra/baking/texel_openness.h"

#include <algorithm>
#include <stdexcept>

#include "penumbra/baking/sample_points.h"
#include "penumbra/math/rng.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr std::size_t lanes = Outlook::lanes;

/// Sixteen neighbouring texels.
void look_around(const SamplePoints& points, std::span<const std::uint32_t> texels, const OpennessOptions& options,
                 std::vector<float>& open) {
  Outlook outlook(hash_key(options.seed, 7, texels[0]));
  for (std::size_t i = 0; i < texels.size(); ++i) {
    if (points.is_enclosed(texels[i])) continue;
    const Place place = points[texels[i]];
    outlook.set(static_cast<int>(i), points.lifted(place), place.shading, place.normal,
                hash_key(options.seed, 8, texels[i]));
  }
  std::uint32_t free[lanes] = {};
  RayPacket packet;
  for (std::uint32_t k = 0; k < options.rays; ++k) {
    outlook.rays(k, packet);
    std::fill(std::begin(packet.t_max), std::end(packet.t_max), static_cast<float>(options.distance));
    points.tracer().occluded(packet, false);
    for (std::size_t i = 0; i < lanes; ++i) free[i] += packet.active[i] != 0 ? 1U : 0U;
  }
  for (std::size_t i = 0; i < texels.size(); ++i) {
    open[texels[i]] = static_cast<float>(free[i]) / static_cast<float>(options.rays);
  }
}

}  // namespace

TexelOpenness openness_of_texels(const LightmapAtlas& atlas, const Texels& texels, const OpennessOptions& options) {
  if (!(options.distance > 0)) throw std::invalid_argument("the distance of ambient occlusion must be above 0");
  if (options.rays < 16) throw std::invalid_argument("ambient occlusion needs at least 16 rays a texel");
  TexelOpenness found;
  const std::size_t count = texels.count();
  found.open.assign(count, 0);
  found.buried.assign(count, 0);
  if (count == 0) return found;
  const RayTracer tracer(atlas.scene);
  const TexelMap map(atlas, texels);
  const AtlasSpace space(map, tracer);
  const SamplePoints points(tracer, map, space, options.progress);
  for (std::uint32_t t = 0; t < count; ++t) found.buried[t] = points.is_enclosed(t) ? 1 : 0;
  const std::vector<std::uint32_t> order = texels_in_blocks(map);
  const std::size_t groups = (order.size() + lanes - 1) / lanes, round = std::max<std::size_t>(64, groups / 64);
  for (std::size_t start = 0; start < groups; start += round) {
    if (options.progress.stop_requested()) {
      found.partial = true;
      break;
    }
    const std::size_t some = std::min(round, groups - start);
    parallel_for(some, 4, [&](std::size_t first, std::size_t last) {
      for (std::size_t g = start + first; g < start + last; ++g) {
        const std::size_t begin = g * lanes;
        look_around(points, std::span(order).subspan(begin, std::min(lanes, order.size() - begin)), options,
                    found.open);
      }
    });
    found.rays += std::min(some * lanes, order.size() - start * lanes) * options.rays;
    options.progress.tell("ambient occlusion", static_cast<double>(start + some) / static_cast<double>(groups));
  }
  return found;
}

}  // namespace penumbra
