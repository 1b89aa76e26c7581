#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/image/exr_file.h"

namespace penumbra {
namespace {

TEST(ExrFile, HalfKeepsElevenBitsOfEveryChannelAndCutsWhatIsTooLarge) {
  Image image(7, 5);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = std::exp2(static_cast<float>(i) / 7.0F - 8) * (i % 2 == 0 ? 1.0F : -1.0F);
  }
  image.data[0] = 1e9F;
  image.metadata["quantity"] = "irradiance";
  const auto bytes = encode_exr(image, ExrDepth::half);
  EXPECT_LT(bytes.size(), encode_exr(image).size());
  const Image back = decode_exr(bytes, "half");
  ASSERT_EQ(back.width, 7);
  ASSERT_EQ(back.height, 5);
  ASSERT_EQ(back.channels, image.channels);
  EXPECT_EQ(back.data[0], 65504.0F);
  for (std::size_t i = 1; i < image.data.size(); ++i) {
    EXPECT_NEAR(back.data[i], image.data[i], std::abs(image.data[i]) / 2048) << i;
  }
  EXPECT_EQ(back.metadata.at("quantity"), "irradiance");
}

}  // namespace
}  // namespace penumbra
