#include "penumbra/baking/texel_denoising.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/math/spectrum.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr int reach = 3;  // texels to each side that a mean is taken over
constexpr int patch = 1;  // and around each of these, that are compared
constexpr int half = reach + patch, across = 2 * half + 1;
constexpr float strictness = 0.45F;                   // k of eq. 3: noises by which patches may differ
constexpr double same_direction = 0.984807753012208;  // cos 10 degrees

/// What is around a texel, row by row; `none` where it must not be mixed with it.
using Window = std::array<std::uint32_t, std::size_t{across} * across>;
constexpr int at(int right, int down) { return (down + half) * across + right + half; }

class Denoising {
 public:
  Denoising(const SamplePoints& points, std::span<const std::uint8_t> skipped, const std::vector<float>& irradiance,
            const std::vector<float>& error)
      : points_(points), map_(points.map()), skipped_(skipped), irradiance_(irradiance), light_(error.size()) {
    for (std::size_t t = 0; t < light_.size(); ++t) light_[t] = luminance(colour(t));
    smooth_variances(error);
  }

  struct Mean {
    Rgb irradiance{0.0F};
    float error = 0;
  };

  [[nodiscard]] Mean mean_around(std::uint32_t texel) const {
    if (is_alone(texel)) return {colour(texel), std::sqrt(variance_[texel])};
    const Window window = around(texel);
    Rgb sum(0);
    float weights = 0, noise = 0;
    for (int down = -reach; down <= reach; ++down) {
      for (int right = -reach; right <= reach; ++right) {
        const std::uint32_t other = window[static_cast<std::size_t>(at(right, down))];
        if (other == TexelMap::none) continue;
        const float weight = std::exp(-std::max(0.0F, distance(window, right, down)));
        sum += weight * colour(other);
        weights += weight;
        noise += weight * weight * variance_[other];
      }
    }
    return {sum / weights, std::sqrt(noise) / weights};
  }

 private:
  [[nodiscard]] Rgb colour(std::size_t texel) const {
    return {irradiance_[3 * texel], irradiance_[3 * texel + 1], irradiance_[3 * texel + 2]};
  }
  [[nodiscard]] bool is_alone(std::uint32_t texel) const { return skipped_[texel] != 0 || points_.is_cut(texel); }

  /// The error of one texel is a rough guess (two halves of its rays); that of a neighbourhood is better.
  void smooth_variances(const std::vector<float>& error) {
    variance_.resize(error.size());
    parallel_for(error.size(), 1024, [&](std::size_t first, std::size_t last) {
      for (std::size_t t = first; t < last; ++t) {
        float sum = 0, count = 0;
        for (int down = -2; down <= 2; ++down) {
          for (int right = -2; right <= 2; ++right) {
            const std::uint32_t other = map_.beside(static_cast<std::uint32_t>(t), right, down);
            if (other == TexelMap::none || skipped_[other] != 0) continue;
            sum += error[other] * error[other], count += 1;
          }
        }
        variance_[t] = count > 0 ? sum / count : error[t] * error[t];
      }
    });
  }

  /// From the texel outwards over neighbours that may be mixed with it.
  [[nodiscard]] Window around(std::uint32_t texel) const {
    Window window;
    window.fill(TexelMap::none);
    const Vec3d normal = points_[texel].shading;
    std::array<std::pair<int, int>, std::size_t{across} * across> queue;
    std::size_t head = 0, tail = 0;
    window[static_cast<std::size_t>(at(0, 0))] = texel;
    queue[tail++] = {0, 0};
    while (head < tail) {
      const auto [right, down] = queue[head++];
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int x = right + dx, y = down + dy;
        if (std::max(std::abs(x), std::abs(y)) > half) continue;
        std::uint32_t& slot = window[static_cast<std::size_t>(at(x, y))];
        if (slot != TexelMap::none) continue;
        const std::uint32_t other = map_.beside(texel, x, y);
        if (other == TexelMap::none || is_alone(other) || dot(points_[other].shading, normal) < same_direction)
          continue;
        slot = other;
        queue[tail++] = {x, y};
      }
    }
    return window;
  }

  /// How much the patches around the middle and around another texel differ beyond their noise.
  [[nodiscard]] float distance(const Window& window, int right, int down) const {
    float sum = 0, count = 0;
    for (int y = -patch; y <= patch; ++y) {
      for (int x = -patch; x <= patch; ++x) {
        const std::uint32_t p = window[static_cast<std::size_t>(at(x, y))];
        const std::uint32_t q = window[static_cast<std::size_t>(at(right + x, down + y))];
        if (p == TexelMap::none || q == TexelMap::none) continue;
        const float difference = light_[p] - light_[q], noise = variance_[p] + std::min(variance_[p], variance_[q]);
        sum += (difference * difference - noise) / (1e-20F + strictness * strictness * (variance_[p] + variance_[q]));
        count += 1;
      }
    }
    return count > 0 ? sum / count : 0;
  }

  const SamplePoints& points_;
  const TexelMap& map_;
  std::span<const std::uint8_t> skipped_;
  const std::vector<float>& irradiance_;
  std::vector<float> light_, variance_;  // by texel: luminance, its variance
};

}  // namespace

void denoise_texels(const SamplePoints& points, std::span<const std::uint8_t> skipped, std::vector<float>& irradiance,
                    std::vector<float>& error) {
  const Denoising denoising(points, skipped, irradiance, error);
  std::vector<float> smooth(irradiance.size()), rest(error.size());
  parallel_for(error.size(), 256, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) {
      const auto mean = denoising.mean_around(static_cast<std::uint32_t>(t));
      for (int b = 0; b < 3; ++b) smooth[3 * t + static_cast<std::size_t>(b)] = mean.irradiance[b];
      rest[t] = mean.error;
    }
  });
  irradiance.swap(smooth);
  error.swap(rest);
}

}  // namespace penumbra
