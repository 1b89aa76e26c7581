// What a picture says about itself survives in every format.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "penumbra/file/input_file.h"
#include "penumbra/image/image_io.h"

namespace penumbra {
namespace {

class MetadataTest : public testing::TestWithParam<std::string> {
 protected:
  std::string path_ =
      (std::filesystem::temp_directory_path() / ("metadata-" + std::to_string(::getpid()) + GetParam())).string();

  void TearDown() override { std::filesystem::remove(path_); }
};

std::string text_of(const std::vector<std::byte>& bytes) {
  std::string text(bytes.size(), '\0');
  std::ranges::transform(bytes, text.begin(), [](std::byte b) { return static_cast<char>(b); });
  return text;
}

TEST_P(MetadataTest, IsInTheFileAndLeavesThePictureReadable) {
  Image image(9, 3);
  std::ranges::fill(image.data, 1.0F);
  image.metadata = {{"partial", "true"}, {"scene", "a\nFORMAT=none\n\nb"}};
  write_image(path_, image);
  const std::string bytes = text_of(read_file(path_));
  EXPECT_NE(bytes.find("partial"), std::string::npos);
  EXPECT_NE(bytes.find("true"), std::string::npos);
  const Image back = read_image(path_);
  EXPECT_EQ(back.width, 9);
  EXPECT_EQ(back.height, 3);
  for (const float value : back.data) EXPECT_NEAR(value, 1.0F, 0.01F);
}

INSTANTIATE_TEST_SUITE_P(Formats, MetadataTest, testing::Values(".png", ".exr", ".hdr"),
                         [](const auto& test) { return test.param.substr(1); });

}  // namespace
}  // namespace penumbra
