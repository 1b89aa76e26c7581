#include "penumbra/image/layer_picture.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace penumbra {
namespace {

Image layered() {
  Image image(2, 1, {"R", "G", "B", "normal.X", "normal.Y", "normal.Z", "rays.count"});
  image.data = {0.1F, 0.2F, 0.3F, -1, 0, 1, 5, 0.4F, 0.5F, 0.6F, 0, 1, 0, 20};
  return image;
}

TEST(LayerPicture, CountsAreGreyUpToTheLargest) {
  const Image picture = layer_picture(layered(), "rays");
  EXPECT_EQ(picture.rgb(0, 0), Rgb(0.25F));
  EXPECT_EQ(picture.rgb(1, 0), Rgb(1));
  Image endless = layered();
  endless.data[6] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(layer_picture(endless, "rays").rgb(0, 0), Rgb(0));
}

TEST(LayerPicture, NormalsAreMovedIntoSight) {
  const Image picture = layer_picture(layered(), "normal");
  EXPECT_EQ(picture.rgb(0, 0), Rgb(0, 0.5F, 1));
  EXPECT_EQ(picture.rgb(1, 0), Rgb(0.5F, 1, 0.5F));
}

TEST(LayerPicture, AMissingLayerIsNamed) {
  EXPECT_THROW((void)layer_picture(layered(), "depth"), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
