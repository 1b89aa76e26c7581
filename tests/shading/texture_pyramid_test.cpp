#include "penumbra/tracing/shading/texture_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace penumbra {
namespace {

using std::numbers::pi;

constexpr Texture smooth{0, Wrap::repeat, Wrap::repeat, TexelFilter::linear};

/// A grey float image by (column, row).
template <class Value>
TextureImage grey(int width, int height, Value value) {
  std::vector<float> texels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) texels.push_back(static_cast<float>(value(x, y)));
  }
  return {"grey", width, height, 1, std::move(texels)};
}

TEST(TexturePyramid, EveryLevelHasTheImagesMean) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> code(0, 255);
  for (const auto& [width, height] : {std::pair{64, 32}, {37, 21}, {1, 19}, {5, 1}, {1, 1}}) {
    TextureImage image{"noise", width, height, 3, {}};
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 3 * width * height; ++i) bytes.push_back(static_cast<std::uint8_t>(code(random)));
    image.texels = bytes;
    for (const TexelEncoding encoding : {TexelEncoding::linear, TexelEncoding::srgb}) {
      const TexturePyramid pyramid(image, encoding);
      const Vec4f mean = mean_texel(image, encoding);
      for (int level = 1; level <= pyramid.level_count(); ++level) {
        Vec4d sum(0);
        for (const Vec4f& t : pyramid.texels(level)) sum += Vec4d(t);
        sum /= static_cast<double>(pyramid.texels(level).size());
        EXPECT_LT(length(Vec3d(sum) - Vec3d(Vec4d(mean))), 1e-5) << width << "x" << height << " level " << level;
      }
      if (pyramid.level_count() > 0) {
        EXPECT_EQ(pyramid.texels(pyramid.level_count()).size(), 1U);
      }
    }
  }
}

TEST(TexturePyramid, NoFootprintIsThePointAndAnEndlessOneTheMean) {
  const TextureImage image = grey(24, 16, [](int x, int y) { return 0.1 * x + 0.01 * y * y; });
  const TexturePyramid pyramid(image, TexelEncoding::linear);
  for (const Vec2d uv : {Vec2d(0.1, 0.7), Vec2d(0.993, 0.01), Vec2d(-3.3, 8.2)}) {
    EXPECT_NEAR(pyramid.value(smooth, uv, {}).x, texture_value(smooth, image, Vec2f(uv), TexelEncoding::linear).x,
                1e-4);
    const float mean = mean_texel(image, TexelEncoding::linear).x;
    EXPECT_NEAR(pyramid.value(smooth, uv, {{1e9, 0}, {0, 1e9}}).x, mean, 1e-4);
    constexpr double inf = std::numeric_limits<double>::infinity();
    EXPECT_NEAR(pyramid.value(smooth, uv, {{inf, 0}, {0, std::nan("")}}).x, mean, 1e-4);
  }
}

// The mean of an even slope is its value in the middle, whatever it is averaged over.
TEST(TexturePyramid, LeavesAnEvenSlopeAsItIs) {
  const TextureImage image = grey(256, 256, [](int x, int y) { return 0.01 * (x + 0.5) + 0.02 * (y + 0.5); });
  const TexturePyramid pyramid(image, TexelEncoding::linear);
  const Texture texture{0, Wrap::clamp, Wrap::clamp, TexelFilter::linear};
  for (const double size : {0.5, 2.0, 9.0, 30.0}) {
    for (const double angle : {0.0, 0.6, 1.4, 2.5}) {
      for (const double thinness : {1.0, 0.3, 0.08}) {
        const Vec2d along(std::cos(angle), std::sin(angle));
        const TextureFootprint footprint{size / 256 * along, thinness * size / 256 * Vec2d(-along.y, along.x)};
        EXPECT_NEAR(pyramid.value(texture, {0.47, 0.52}, footprint).x, 0.01 * 0.47 * 256 + 0.02 * 0.52 * 256, 2e-3);
      }
    }
  }
}

// Averaged over a parallelogram whose sides reach a and b across its crests, a wave of frequency f (per texel) keeps
// sin(pi f a) / (pi f a) x sin(pi f b) / (pi f b) of its height.
TEST(TexturePyramid, SpreadsAsFarAsTheFootprint) {
  constexpr int size = 512;
  const double f = 1.0 / 64;
  const TextureImage image = grey(size, size, [&](int x, int) { return 1 + std::cos(2 * pi * f * (x + 0.5)); });
  const TexturePyramid pyramid(image, TexelEncoding::linear);
  for (const double wide : {24.0, 32.0, 40.0}) {
    for (const double angle : {0.0, 0.5, 1.0, 1.5}) {
      for (const double thinness : {1.0, 0.5, 0.2}) {
        const Vec2d a = wide * Vec2d(std::cos(angle), std::sin(angle));
        const Vec2d b = thinness * wide * Vec2d(-std::sin(angle), std::cos(angle));
        const double variance = (a.x * a.x + b.x * b.x) / 12;
        if (variance < 20) continue;
        const auto left = [&](double side) { return side == 0 ? 1 : std::sin(pi * f * side) / (pi * f * side); };
        const double expected = left(a.x) * left(b.x);
        double sum = 0;  // over places, as levels do not blur all places alike
        for (int k = 0; k < 64; ++k) {
          const double u = 0.5 + k / double{size};
          const double height = pyramid.value(smooth, {u, 0.3}, {a / double{size}, b / double{size}}).x - 1;
          sum += height * std::cos(2 * pi * f * u * size);
        }
        const double kept = 2 * sum / 64;
        EXPECT_NEAR(1 - kept, 1 - expected, 0.1 * (1 - expected)) << wide << " " << angle << " " << thinness;
      }
    }
  }
}

TEST(TexturePyramid, WrapsAsTheTextureSays) {
  const TextureImage image = grey(64, 64, [](int x, int) { return x < 32 ? 1 : 0; });
  const TexturePyramid pyramid(image, TexelEncoding::linear);
  const TextureFootprint wide{{8.0 / 64, 0}, {0, 8.0 / 64}};
  EXPECT_NEAR(pyramid.value(smooth, {0.0, 0.5}, wide).x, 0.5, 0.02);  // between the last column and the first
  const Texture clamped{0, Wrap::clamp, Wrap::clamp, TexelFilter::linear};
  EXPECT_NEAR(pyramid.value(clamped, {0.0, 0.5}, wide).x, 1, 0.02);
  const Texture folded{0, Wrap::mirror, Wrap::mirror, TexelFilter::linear};
  EXPECT_NEAR(pyramid.value(folded, {1.0, 0.5}, wide).x, 0, 0.02);
}

TEST(TexturePyramid, AnAtlasWithoutMipmapsIsReadAtThePoint) {
  const TextureImage image = grey(64, 64, [](int x, int y) { return (x + y) % 2; });
  const TexturePyramid pyramid(image, TexelEncoding::linear);
  Texture atlas = smooth;
  atlas.mipmaps = false;
  const Vec2d uv(10.5 / 64, 11.5 / 64);
  EXPECT_NEAR(pyramid.value(atlas, uv, {{0.2, 0}, {0, 0.2}}).x, 1, 1e-6);
}

}  // namespace
}  // namespace penumbra
