#include "penumbra/baking/directional_texels.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>

#include "penumbra/baking/spherical_harmonics.h"
#include "penumbra/math/rng.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr std::size_t lanes = Outlook::lanes;
using Harmonics = std::array<Rgb, 4>;

void add(const Vec3d& direction, const Rgb& light, Harmonics& sums) {
  const std::array<double, 9> y = spherical_harmonics(direction);
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += static_cast<float>(y[k]) * light;
}

/// Sixteen neighbouring texels.
void gather(const TexelSolution& solution, std::span<const std::uint32_t> texels,
            const DirectionalTexelsOptions& options, std::vector<float>& coefficients) {
  const std::uint64_t key = hash_key(options.seed, 9, texels[0]);
  Outlook outlook(key, Spread::even);
  std::array<Harmonics, lanes> sums{};
  for (std::size_t i = 0; i < texels.size(); ++i) {
    if (solution.cells().is_buried(texels[i])) continue;
    const Place place = solution.points()[texels[i]];
    const Vec3d origin = solution.points().lifted(place);
    outlook.set(static_cast<int>(i), origin, place.normal, place.normal, hash_key(options.seed, 10, texels[i]));
    for (const auto& beam : solution.straight().beams(origin, place.normal, options.lamp_samples, hash_key(key, i))) {
      add(beam.direction, beam.irradiance, sums[i]);
    }
  }
  // Each ray stands for 2 pi / rays of solid angle; radiance is radiosity over pi.
  const float share = 2.0F / static_cast<float>(options.rays);
  RayPacket packet;
  Landing landings[lanes];
  for (std::uint32_t k = 0; k < options.rays; ++k) {
    outlook.rays(k, packet);
    solution.rays().trace(packet, hash_key(key, k), landings);
    for (std::size_t i = 0; i < texels.size(); ++i) {
      const Landing& l = landings[i];
      Rgb light = l.extra;
      if (l.side != Landing::nowhere) light += l.weight * Rgb(solution.cells().radiosity(l.side));
      add({packet.direction_x[i], packet.direction_y[i], packet.direction_z[i]}, share * light, sums[i]);
    }
  }
  for (std::size_t i = 0; i < texels.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      for (int b = 0; b < 3; ++b) {
        coefficients[3 * (std::size_t{4} * texels[i] + k) + static_cast<std::size_t>(b)] = sums[i][k][b];
      }
    }
  }
}

}  // namespace

DirectionalTexels bake_directional_texels(const TexelSolution& solution, const DirectionalTexelsOptions& options) {
  if (options.rays < 16) throw std::invalid_argument("a directional lightmap needs at least 16 rays a texel");
  if (options.lamp_samples < 1) throw std::invalid_argument("a texel needs at least one shadow ray to each lamp");
  DirectionalTexels light;
  const std::span<const std::uint32_t> order = solution.order();
  light.coefficients.assign(12 * order.size(), 0);
  const std::size_t groups = (order.size() + lanes - 1) / lanes, round = std::max<std::size_t>(64, groups / 64);
  for (std::size_t start = 0; start < groups; start += round) {
    if (options.progress.stop_requested()) {
      light.partial = true;
      break;
    }
    parallel_for(std::min(round, groups - start), 4, [&](std::size_t first, std::size_t last) {
      for (std::size_t g = start + first; g < start + last; ++g) {
        const std::size_t begin = g * lanes;
        gather(solution, order.subspan(begin, std::min(lanes, order.size() - begin)), options, light.coefficients);
      }
    });
    options.progress.tell("directional light",
                          static_cast<double>(std::min(groups, start + round)) / static_cast<double>(groups));
  }
  return light;
}

}  // namespace penumbra
