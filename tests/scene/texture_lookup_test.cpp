#include "penumbra/scene/texture_lookup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace penumbra {
namespace {

/// 4 x 2 grey texels 0, 10, 20 ... 70.
TextureImage ramp() {
  TextureImage image{"ramp", 4, 2, 1, {}};
  image.texels = std::vector<std::uint8_t>{0, 10, 20, 30, 40, 50, 60, 70};
  return image;
}

float code_at(const Texture& texture, Vec2f uv) {
  return 255 * texture_value(texture, ramp(), uv, TexelEncoding::linear).x;
}

Texture with(Wrap wrap, TexelFilter filter) { return {0, wrap, wrap, filter}; }

TEST(TextureLookup, TexelCentresGiveTheTexelInEveryMode) {
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
    for (const TexelFilter filter : {TexelFilter::nearest, TexelFilter::linear}) {
      for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 4; ++x) {
          const Vec2f centre((x + 0.5F) / 4, (y + 0.5F) / 2);
          EXPECT_NEAR(code_at(with(wrap, filter), centre), 10 * (4 * y + x), 1e-4);
        }
      }
    }
  }
}

TEST(TextureLookup, BetweenCentresIsLinear) {
  const Texture t = with(Wrap::repeat, TexelFilter::linear);
  EXPECT_NEAR(code_at(t, {0.25F, 0.25F}), 5, 1e-4);
  EXPECT_NEAR(code_at(t, {0.125F + 0.25F * 0.3F, 0.25F}), 3, 1e-4);
  EXPECT_NEAR(code_at(t, {0.5F, 0.5F}), (10 + 20 + 50 + 60) / 4.0, 1e-4);
}

TEST(TextureLookup, BordersFollowTheWrapMode) {
  const Vec2f left(0, 0.25F);  // half way between column 0 and what lies beyond
  EXPECT_NEAR(code_at(with(Wrap::repeat, TexelFilter::linear), left), 15, 1e-4);  // columns 3 and 0
  EXPECT_NEAR(code_at(with(Wrap::clamp, TexelFilter::linear), left), 0, 1e-4);
  EXPECT_NEAR(code_at(with(Wrap::mirror, TexelFilter::linear), left), 0, 1e-4);
}

TEST(TextureLookup, OutsideFollowsTheWrapMode) {
  for (const TexelFilter filter : {TexelFilter::nearest, TexelFilter::linear}) {
    const Vec2f beyond(1.375F, 0.25F);  // column 1 of the next tile
    EXPECT_NEAR(code_at(with(Wrap::repeat, filter), beyond), 10, 1e-4);
    EXPECT_NEAR(code_at(with(Wrap::clamp, filter), beyond), 30, 1e-4);
    EXPECT_NEAR(code_at(with(Wrap::mirror, filter), beyond), 20, 1e-4);
    const Vec2f before(-0.125F, 0.25F);
    EXPECT_NEAR(code_at(with(Wrap::repeat, filter), before), 30, 1e-4);
    EXPECT_NEAR(code_at(with(Wrap::clamp, filter), before), 0, 1e-4);
    EXPECT_NEAR(code_at(with(Wrap::mirror, filter), before), 0, 1e-4);
  }
}

TEST(TextureLookup, StrangeCoordinatesStayInside) {
  const float huge = std::numeric_limits<float>::max();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
    for (const TexelFilter filter : {TexelFilter::nearest, TexelFilter::linear}) {
      for (const float u : {huge, -huge, nan, infinite, -infinite, -1e-30F, 1.0F, -1.0F, 2.0F, 16777217.0F}) {
        for (const Vec2f uv : {Vec2f(u, 0.5F), Vec2f(0.5F, u), Vec2f(u, u)}) {
          const float code = code_at(with(wrap, filter), uv);
          EXPECT_GE(code, 0);
          EXPECT_LE(code, 70.001F);
        }
      }
    }
  }
}

TEST(TextureLookup, ChannelsMeanGreyAlphaColour) {
  const Texture t;
  const auto value = [&](int channels, std::vector<std::uint8_t> texels) {
    TextureImage image{"", 1, 1, channels, std::move(texels)};
    return 255.0F * texture_value(t, image, {0.5F, 0.5F}, TexelEncoding::linear);
  };
  EXPECT_LT(glm::distance(value(1, {51}), Vec4f(51, 51, 51, 255)), 1e-3);
  EXPECT_LT(glm::distance(value(2, {51, 102}), Vec4f(51, 51, 51, 102)), 1e-3);
  EXPECT_LT(glm::distance(value(3, {1, 2, 3}), Vec4f(1, 2, 3, 255)), 1e-3);
  EXPECT_LT(glm::distance(value(4, {1, 2, 3, 4}), Vec4f(1, 2, 3, 4)), 1e-3);
}

TEST(TextureLookup, SrgbIsDecodedBeforeFiltering) {
  TextureImage image{"", 2, 1, 4, std::vector<std::uint8_t>{0, 0, 0, 0, 255, 255, 255, 255}};
  const Vec4f middle = texture_value(Texture{}, image, {0.5F, 0.5F}, TexelEncoding::srgb);
  EXPECT_NEAR(middle.x, 0.5, 1e-6);
  EXPECT_NEAR(middle.w, 0.5, 1e-6);
  image.texels = std::vector<std::uint8_t>{188, 10, 128, 128, 188, 10, 128, 128};
  const Vec4f even = texture_value(Texture{}, image, {0.5F, 0.5F}, TexelEncoding::srgb);
  EXPECT_NEAR(even.x, std::pow((188 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
  EXPECT_NEAR(even.y, 10 / 255.0 / 12.92, 1e-7);
  EXPECT_NEAR(even.w, 128 / 255.0, 1e-6);  // alpha is never encoded
}

TEST(TextureLookup, FloatTexelsAreLinearAndUnbounded) {
  TextureImage image{"", 1, 1, 3, std::vector<float>{0.5F, 4.0F, 1000.0F}};
  const Vec4f value = texture_value(Texture{}, image, {0.2F, 0.9F}, TexelEncoding::srgb);
  EXPECT_LT(glm::distance(value, Vec4f(0.5F, 4, 1000, 1)), 1e-3);
}

TEST(TextureLookup, AnImageWithoutItsTexelsIsWhite) {
  EXPECT_EQ(texture_value(Texture{}, TextureImage{}, {0, 0}, TexelEncoding::linear), Vec4f(1));
  TextureImage cut{"cut", 4, 4, 4, std::vector<std::uint8_t>(10)};
  EXPECT_EQ(texture_value(Texture{}, cut, {0, 0}, TexelEncoding::linear), Vec4f(1));
}

TEST(TextureLookup, AReferenceChoosesTheSetAndTransforms) {
  Scene scene;
  scene.images.push_back(ramp());
  scene.textures.push_back(with(Wrap::repeat, TexelFilter::nearest));
  const Vec2f uv[2] = {{0.125F, 0.25F}, {0.625F, 0.75F}};
  TextureRef ref;
  const auto code = [&] { return 255 * texture_value(scene, ref, uv, TexelEncoding::linear).x; };
  EXPECT_NEAR(code(), 0, 1e-4);
  ref.uv_set = 1;
  EXPECT_NEAR(code(), 60, 1e-4);
  ref.uv_set = 0;
  ref.transform[2] = {0.25F, 0.5F, 1};  // offset (0.25, 0.5)
  EXPECT_NEAR(code(), 50, 1e-4);
}

}  // namespace
}  // namespace penumbra
