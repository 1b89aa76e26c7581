#include "penumbra/image/tonemap.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

TEST(Srgb, KnownValues) {
  // IEC 61966-2-1: 1.055 * 0.5^(1/2.4) - 0.055.
  EXPECT_NEAR(srgb_encode(0.5F), 0.735357F, 1e-6F);
  EXPECT_NEAR(srgb_encode(0.18F), 0.461356F, 1e-6F);
  EXPECT_NEAR(srgb_decode(0.5F), 0.214041F, 1e-6F);
  EXPECT_EQ(srgb_encode(0.0F), 0.0F);
  EXPECT_NEAR(srgb_encode(1.0F), 1.0F, 1e-6F);
}

TEST(Srgb, DecodingUndoesEncoding) {
  for (int i = -100; i <= 3000; ++i) {
    const float linear = static_cast<float>(i) * 0.001F;
    EXPECT_NEAR(srgb_decode(srgb_encode(linear)), linear, 2e-6F * std::max(1.0F, linear));
  }
}

TEST(Srgb, EightBitCodesAreTheNearest) {
  for (int i = 0; i <= 100000; ++i) {
    const float linear = static_cast<float>(i) / 100000.0F;
    const double x = linear;
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    EXPECT_LE(std::abs(encoded * 255 - srgb_encode8(linear)), 0.5 + 1e-4) << linear;
  }
}

TEST(Srgb, EightBitCodesOfOddValues) {
  EXPECT_EQ(srgb_encode8(NAN), 0);
  EXPECT_EQ(srgb_encode8(-INFINITY), 0);
  EXPECT_EQ(srgb_encode8(-0.0F), 0);
  EXPECT_EQ(srgb_encode8(INFINITY), 255);
  EXPECT_EQ(srgb_encode8(std::nextafter(1.0F, 0.0F)), 255);
}

TEST(Tonemap, ExposureDoublesForEachStopAndLeavesAlphaAlone) {
  Image image(1, 1, {"R", "G", "B", "A"});
  image.data = {0.25F, 3.0F, 0.0F, 0.5F};
  EXPECT_EQ(tonemapped(image, 2, ToneCurve::none).data, (std::vector<float>{1.0F, 12.0F, 0.0F, 0.5F}));
  EXPECT_EQ(tonemapped(image, -1, ToneCurve::srgb).data, (std::vector<float>{0.125F, 1.5F, 0.0F, 0.5F}));
}

TEST(Tonemap, FilmicCurveRisesFromBlackToWhite) {
  Image image(1000, 1, {"Y"});
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = std::exp2(static_cast<float>(i) * 0.16F - 20);
  image.data[0] = 0;
  image.data.back() = 3e38F;
  const Image out = tonemapped(image, 0, ToneCurve::filmic);
  EXPECT_EQ(out.data.front(), 0.0F);
  EXPECT_EQ(out.data.back(), 1.0F);
  for (std::size_t i = 1; i < out.data.size(); ++i) EXPECT_GE(out.data[i], out.data[i - 1]);
}

}  // namespace
}  // namespace penumbra
