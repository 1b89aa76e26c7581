#include "penumbra/image/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

Image noise(int width, int height, std::uint64_t seed, std::vector<std::string> channels = {"R", "G", "B"}) {
  Image image(width, height, std::move(channels));
  CounterRng rng(seed);
  for (auto& v : image.data) v = static_cast<float>(rng.next());
  return image;
}

Image filled(int width, int height, float value) {
  Image image(width, height);
  for (auto& v : image.data) v = value;
  return image;
}

TEST(Compare, EqualPicturesHaveNoDistance) {
  const Image a = noise(40, 30, 1);
  const ImageDifference d = compare(a, a);
  EXPECT_EQ(d.rmse, 0);
  EXPECT_EQ(d.relative_rmse, 0);
  EXPECT_FALSE(d.psnr.has_value());
  EXPECT_EQ(d.ssim, 1);
  EXPECT_EQ(d.max, 0);
  EXPECT_EQ(d.mean_a, d.mean_b);
}

TEST(Compare, ConstantOffset) {
  const ImageDifference d = compare(filled(20, 20, 0.5F), filled(20, 20, 0.75F));
  EXPECT_DOUBLE_EQ(d.rmse, 0.25);
  EXPECT_DOUBLE_EQ(d.relative_rmse, 0.5);
  EXPECT_DOUBLE_EQ(d.max, 0.25);
  EXPECT_DOUBLE_EQ(*d.psnr, 20 * std::log10(4.0));
  EXPECT_DOUBLE_EQ(d.mean_a, 0.5);
  EXPECT_DOUBLE_EQ(d.mean_b, 0.75);
  // Flat pictures have no variance, so only the luminance term remains (Wang et al. 2004, equation 6).
  EXPECT_NEAR(d.ssim, (2 * 0.5 * 0.75 + 1e-4) / (0.25 + 0.5625 + 1e-4), 1e-12);
}

TEST(Compare, PsnrCountsFromTheLargestValueOfA) {
  Image a = filled(12, 12, 0.0F);
  a.data[5] = 8.0F;
  Image b = a;
  for (auto& v : b.data) v += 0.5F;
  EXPECT_DOUBLE_EQ(*compare(a, b).psnr, 20 * std::log10(16.0));
}

TEST(Compare, OnePixelOff) {
  const Image a = filled(10, 10, 0.0F);
  Image b = a;
  b.data[3 * 42 + 1] = 0.3F;
  const ImageDifference d = compare(a, b);
  EXPECT_NEAR(d.rmse, 0.3 / std::sqrt(300.0), 1e-8);
  EXPECT_EQ(d.relative_rmse, std::numeric_limits<double>::infinity());
  EXPECT_FLOAT_EQ(static_cast<float>(d.max), 0.3F);
}

TEST(Compare, StructureOfTheNegativeIsOpposite) {
  const Image a = noise(64, 64, 4);
  Image negative = a;
  for (auto& v : negative.data) v = 1 - v;
  const Image other = noise(64, 64, 5);
  EXPECT_LT(compare(a, negative).ssim, -0.5);
  EXPECT_NEAR(compare(a, other).ssim, 0, 0.1);
  Image slightly = a;
  for (std::size_t i = 0; i < a.data.size(); ++i) slightly.data[i] += 0.01F * (other.data[i] - 0.5F);
  EXPECT_GT(compare(a, slightly).ssim, 0.99);
}

TEST(Compare, IsSymmetricInItsDistances) {
  const Image a = noise(33, 17, 6);
  const Image b = noise(33, 17, 7);
  EXPECT_DOUBLE_EQ(compare(a, b).rmse, compare(b, a).rmse);
  EXPECT_NEAR(compare(a, b).ssim, compare(b, a).ssim, 1e-12);
}

TEST(Compare, AlphaAndFurtherChannelsAreNotJudged) {
  Image a = noise(9, 9, 8, {"R", "G", "B", "A"});
  Image b = a;
  for (std::size_t i = 3; i < b.data.size(); i += 4) b.data[i] += 1;
  EXPECT_EQ(compare(a, b).rmse, 0);
}

TEST(Compare, GreyAgainstColour) {
  const Image grey = noise(9, 9, 8, {"Y"});
  Image colour(9, 9);
  for (std::size_t i = 0; i < colour.data.size(); ++i) colour.data[i] = grey.data[i / 3];
  EXPECT_EQ(compare(grey, colour).rmse, 0);
  EXPECT_EQ(compare(colour, grey).rmse, 0);
}

TEST(Compare, NotANumberIsInfinitelyFar) {
  const Image a = filled(12, 12, 0.5F);
  Image b = a;
  b.data[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(compare(a, b).rmse, std::numeric_limits<double>::infinity());
  EXPECT_EQ(compare(b, b).rmse, std::numeric_limits<double>::infinity());
}

TEST(Compare, OtherSizesAreRefused) {
  EXPECT_THROW(static_cast<void>(compare(Image(3, 4), Image(4, 3))), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(compare(Image(), Image())), std::invalid_argument);
}

TEST(Compare, PicturesSmallerThanTheWindow) {
  EXPECT_LT(compare(noise(1, 1, 1), noise(1, 1, 2)).ssim, 1);
  EXPECT_EQ(compare(noise(30, 4, 1), noise(30, 4, 1)).ssim, 1);
}

}  // namespace
}  // namespace penumbra
