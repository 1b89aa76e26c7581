#include "penumbra/baking/dithering.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/image/tonemap.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

/// Linear light of each code.
std::array<float, 256> code_values() {
  std::array<float, 256> values{};
  for (std::size_t c = 0; c < 256; ++c) values[c] = srgb_decode(static_cast<float>(c) / 255.0F);
  return values;
}

/// The threshold of a pixel, in (0, 1): bits of x ^ y and y, reversed and interleaved.
float threshold(std::size_t x, std::size_t y) {
  std::size_t rank = 0;
  for (std::size_t bit = 0; bit < 3; ++bit) {
    rank = rank << 2 | ((x ^ y) >> bit & 1U) << 1 | (y >> bit & 1U);
  }
  return (static_cast<float>(rank) + 0.5F) / 64;
}

std::uint8_t code(float light, float between, const std::array<float, 256>& values) {
  if (!(light > 0)) return 0;
  if (light >= 1) return 255;
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(values, light) - values.begin());
  const std::size_t below = above - 1;
  const float share = (light - values[below]) / (values[above] - values[below]);
  return static_cast<std::uint8_t>(share > between ? above : below);
}

}  // namespace

std::vector<std::uint8_t> dithered_srgb8(const Image& image, float scale) {
  const std::array<float, 256> values = code_values();
  const std::size_t channels = image.channels.size(), width = static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> codes(image.data.size());
  parallel_for(static_cast<std::size_t>(image.height), 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first * width; i < last * width; ++i) {
      const float between = threshold(i % width, i / width);
      for (std::size_t c = 0; c < channels; ++c) {
        const float value = image.data[i * channels + c];
        codes[i * channels + c] = c < 3 ? code(scale * value, between, values)
                                        : static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
      }
    }
  });
  return codes;
}

}  // namespace penumbra
