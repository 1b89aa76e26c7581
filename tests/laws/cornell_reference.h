#pragma once

// A picture of the Cornell box that another renderer made, and how far another picture lies from it.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "penumbra/image/image.h"
#include "test_paths.h"

namespace penumbra::cornell_reference {

inline constexpr int reference_side = 256;

inline Image read_reference() {
  std::ifstream in(PENUMBRA_TEST_DATA "/cornell_reference/cornell_256.npy", std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
  Image image(reference_side, reference_side);
  const std::size_t payload = image.data.size() * sizeof(float);
  EXPECT_GT(bytes.size(), payload);
  std::memcpy(image.data.data(), bytes.data() + (bytes.size() - payload), payload);
  return image;
}

// Lamp pixels (10 and more) of a square picture and two pixels around them.
inline std::vector<char> lamp_mask(const Image& reference) {
  const int side = reference.width;
  std::vector<char> mask(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      if (max_component(reference.rgb(x, y)) < 10) continue;
      for (int v = std::max(0, y - 2); v <= std::min(side - 1, y + 2); ++v) {
        for (int u = std::max(0, x - 2); u <= std::min(side - 1, x + 2); ++u)
          mask[static_cast<std::size_t>(v * side + u)] = 1;
      }
    }
  }
  return mask;
}

// Root mean square of the difference of 4 x 4-pixel means, over the mean.
inline double block_error(const Image& a, const Image& reference) {
  const int side = reference.width;
  const std::vector<char> mask = lamp_mask(reference);
  double squares = 0, sum = 0;
  int blocks = 0;
  for (int y = 0; y < side; y += 4) {
    for (int x = 0; x < side; x += 4) {
      Vec3d da(0), dr(0);
      int n = 0;
      for (int k = 0; k < 16; ++k) {
        const int u = x + k % 4, v = y + k / 4;
        if (mask[static_cast<std::size_t>(v * side + u)]) continue;
        da += Vec3d(a.rgb(u, v));
        dr += Vec3d(reference.rgb(u, v));
        ++n;
      }
      if (n == 0) continue;
      squares += length_squared((da - dr) / static_cast<double>(n)) / 3;
      sum += (dr.x + dr.y + dr.z) / (3.0 * n);
      ++blocks;
    }
  }
  return std::sqrt(squares / blocks) / (sum / blocks);
}

}  // namespace penumbra::cornell_reference
