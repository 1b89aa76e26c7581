#include "penumbra/render/camera_rays.h"

#include <gtest/gtest.h>

#include "tracing/soup.h"

namespace penumbra {
namespace {

TEST(CameraRays, AreTheCamerasRays) {
  testing::Dice dice(1);
  for (int n = 0; n < 200; ++n) {
    const Vec3d eye = dice.cube(10);
    Camera camera;
    camera.to_world = look_at(eye, eye + dice.direction(), dice.direction());
    camera.to_world[0] *= dice.between(0.1, 3);  // scale is ignored
    if (n % 2 == 0) {
      camera.lens = PerspectiveLens{dice.between(0.05, 2.8)};
    } else {
      camera.lens = OrthographicLens{dice.between(0.1, 20)};
    }
    const int width = 1 + static_cast<int>(dice.below(2000));
    const int height = 1 + static_cast<int>(dice.below(2000));
    const CameraRays rays(camera, width, height, FilterKind::box, 1);
    EXPECT_EQ(rays.orthographic(), n % 2 == 1);
    for (int i = 0; i < 20; ++i) {
      const double x = dice.between(0, width), y = dice.between(0, height);
      const Ray ours = rays.through(x, y);
      const Ray theirs = camera.ray(x / width, y / height, static_cast<double>(width) / height);
      ASSERT_LT(length(ours.origin - theirs.origin), 1e-9);
      ASSERT_LT(length(ours.direction - theirs.direction), 1e-9);
      ASSERT_NEAR(length(ours.direction), 1, 1e-12);
    }
  }
}

TEST(CameraRays, OneSampleGoesThroughTheMiddleMoreAreSpread) {
  const Camera camera;
  PixelSampler sampler(0, 3, 4, 0);
  const CameraRays one(camera, 10, 10, FilterKind::gaussian, 1);
  const auto [ray, weight] = one.ray(3, 4, sampler);
  EXPECT_EQ(weight, 1);
  EXPECT_LT(length(ray.direction - one.through(3.5, 4.5).direction), 1e-15);
  const CameraRays many(camera, 10, 10, FilterKind::box, 16);
  Vec3d mean(0);
  bool spread = false;
  for (int s = 0; s < 256; ++s) {
    PixelSampler next(0, 3, 4, s);
    const Vec3d direction = many.ray(3, 4, next).ray.direction;
    spread = spread || length(direction - ray.direction) > 1e-3;
    mean += direction / 256.0;
  }
  EXPECT_TRUE(spread);
  EXPECT_LT(length(normalize(mean) - ray.direction), 1e-3);
}

TEST(PixelSampler, NumbersDependOnPixelSampleDimensionAndSeedAlone) {
  const auto draw = [](std::uint64_t seed, int x, int y, int sample, int skip) {
    PixelSampler s(seed, x, y, sample);
    for (int i = 0; i < skip; ++i) (void)s.next_2d();
    return s.next_2d();
  };
  const Vec2d base = draw(1, 2, 3, 4, 0);
  EXPECT_EQ(base, draw(1, 2, 3, 4, 0));
  for (const Vec2d& other :
       {draw(2, 2, 3, 4, 0), draw(1, 3, 3, 4, 0), draw(1, 2, 4, 4, 0), draw(1, 2, 3, 5, 0), draw(1, 2, 3, 4, 1)}) {
    EXPECT_NE(base, other);
  }
  // The samples of a pixel are a (0,2)-net: 16 of them stand in 16 different rows, columns and squares.
  int rows = 0, columns = 0, squares = 0;
  for (int s = 0; s < 16; ++s) {
    const Vec2d u = draw(7, 5, 5, s, 3);
    ASSERT_TRUE(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
    rows |= 1 << static_cast<int>(u.x * 16);
    columns |= 1 << static_cast<int>(u.y * 16);
    squares |= 1 << (4 * static_cast<int>(u.x * 4) + static_cast<int>(u.y * 4));
  }
  EXPECT_EQ(rows, 0xFFFF);
  EXPECT_EQ(columns, 0xFFFF);
  EXPECT_EQ(squares, 0xFFFF);
}

}  // namespace
}  // namespace penumbra
