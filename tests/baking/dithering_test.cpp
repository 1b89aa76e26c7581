#include "penumbra/baking/dithering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "penumbra/image/tonemap.h"

namespace penumbra {
namespace {

float decoded(std::uint8_t code) { return srgb_decode(static_cast<float>(code) / 255); }

TEST(Dithering, TheMeanOfAnAreaIsItsLight) {
  for (int k = 1; k < 1000; k += 7) {
    const float light = static_cast<float>(k) / 1000;
    Image image(16, 8);
    std::ranges::fill(image.data, light);
    const std::vector<std::uint8_t> codes = dithered_srgb8(image);
    double sum = 0;
    for (const std::uint8_t c : codes) sum += decoded(c);
    const auto [low, high] = std::ranges::minmax(codes);
    EXPECT_LE(high - low, 1);
    // A sixty-fourth of the step between two codes is what a pattern of 64 thresholds can miss.
    const float step = decoded(static_cast<std::uint8_t>(low + 1)) - decoded(low);
    EXPECT_NEAR(sum / static_cast<double>(codes.size()), light, step / 100 + 1e-6) << light;
  }
}

TEST(Dithering, EveryCodeIsKept) {
  Image image(256, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 256; ++x) image.set_rgb(x, y, Rgb(decoded(static_cast<std::uint8_t>(x))));
  }
  const std::vector<std::uint8_t> codes = dithered_srgb8(image);
  for (std::size_t i = 0; i < codes.size(); ++i) ASSERT_EQ(codes[i], i / 3 % 256);
}

TEST(Dithering, CutsAtBlackAndWhiteAndScalesFirst) {
  Image image(2, 1, {"R", "G", "B", "A"});
  image.data = {-1.0F, 0.0F, 0.25F, 0.5F, 0.5F, 7.0F, std::nanf(""), 1.0F};
  const std::vector<std::uint8_t> codes = dithered_srgb8(image, 2);
  EXPECT_EQ(codes[0], 0);
  EXPECT_EQ(codes[1], 0);
  EXPECT_NEAR(codes[2], 188, 1) << "0.5, encoded";
  EXPECT_EQ(codes[3], 128) << "alpha is not light: neither scaled nor encoded";
  EXPECT_EQ(codes[4], 255);
  EXPECT_EQ(codes[5], 255);
  EXPECT_EQ(codes[6], 0);
  EXPECT_EQ(codes[7], 255);
}

TEST(Dithering, AllThresholdsOfABlockDiffer) {
  Image image(8, 8);
  // Sixty-four steps between two codes show each threshold once.
  std::set<std::size_t> counts;
  for (int k = 0; k <= 64; ++k) {
    const float a = decoded(100), b = decoded(101);
    std::ranges::fill(image.data, a + (b - a) * static_cast<float>(k) / 64);
    const std::vector<std::uint8_t> codes = dithered_srgb8(image);
    counts.insert(static_cast<std::size_t>(std::ranges::count(codes, 101) / 3));
  }
  EXPECT_EQ(counts.size(), 65U);
}

}  // namespace
}  // namespace penumbra
