#include "penumbra/render/camera_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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
    EXPECT_EQ(rays.is_pinhole(), n % 2 == 0);
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

// Directions of the whole sphere: the middle is the view, a quarter to the right is right, the top edge is up.
TEST(CameraRays, APanoramaSeesEverything) {
  const Camera camera{.name = "", .to_world = look_at({1, 2, 3}, {1, 2, 0}, {0, 1, 0}), .lens = PanoramicLens{}};
  const CameraRays rays(camera, 400, 200, FilterKind::box, 1);
  EXPECT_FALSE(rays.is_pinhole());
  const auto expect_direction = [&](double x, double y, const Vec3d& direction) {
    EXPECT_LT(length(rays.through(x, y).direction - direction), 1e-12) << x << " " << y;
    EXPECT_LT(length(rays.through(x, y).origin - Vec3d(1, 2, 3)), 1e-12);
  };
  expect_direction(200, 100, {0, 0, -1});
  expect_direction(300, 100, {1, 0, 0});
  expect_direction(100, 100, {-1, 0, 0});
  expect_direction(0, 100, {0, 0, 1});
  expect_direction(123, 0, {0, 1, 0});
  expect_direction(200, 150, Vec3d(0, -1, -1) / std::sqrt(2.0));
}

// Angles grow evenly from the middle, in every direction; outside the circle there is nothing.
TEST(CameraRays, AFisheyeIsEquidistant) {
  const double fov = 3.5;
  const Camera camera{.name = "", .to_world = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}), .lens = FisheyeLens{fov}};
  for (const auto& [width, height] : {std::pair{300, 200}, {200, 300}}) {
    const CameraRays rays(camera, width, height, FilterKind::box, 1);
    testing::Dice dice(3);
    for (int n = 0; n < 1000; ++n) {
      const Vec2d at(dice.between(0, width), dice.between(0, height));
      const Vec2d from_middle = at - Vec2d(width, height) / 2.0;
      const Vec3d direction = rays.through(at.x, at.y).direction;
      if (length(from_middle) > 100) {
        EXPECT_EQ(direction, Vec3d(0));
        continue;
      }
      ASSERT_NEAR(length(direction), 1, 1e-12);
      EXPECT_NEAR(std::acos(std::clamp(-direction.z, -1.0, 1.0)), length(from_middle) / 100 * fov / 2, 1e-7);
      EXPECT_NEAR(direction.x * -from_middle.y, direction.y * from_middle.x, 1e-9);  // the same azimuth
    }
    PixelSampler sampler(0, 0, 0, 0);
    EXPECT_EQ(rays.ray(0, 0, sampler).weight, 0);
  }
}

// The circle of confusion that the lens formula gives (tests/data/optics.json): aperture f / N, and a point at distance
// s is spread over c on the film.
TEST(CameraRays, BlurIsTheThinLensesCircleOfConfusion) {
  struct Case {
    double f, n, aperture, focus, s, c;
  };
  for (const Case& k : {Case{0.05, 2, 0.025, 2, 1, 0.0006410256410256411},
                        {0.05, 2, 0.025, 2, 1.5, 0.0002136752136752137},
                        {0.05, 2, 0.025, 2, 3, 0.0002136752136752137},
                        {0.05, 2, 0.025, 2, 10, 0.0005128205128205129}}) {
    // The film stands where the plane in focus is sharp; what it shows is the field of view.
    const double film = 1 / (1 / k.f - 1 / k.focus), frame = 0.024;
    const double fov = 2 * std::atan(frame / 2 / film);
    Camera camera{.name = "", .to_world = Mat4d(1.0), .lens = PerspectiveLens{fov}};
    camera.thin_lens = thin_lens(k.n, k.focus, fov, frame);
    EXPECT_NEAR(2 * camera.thin_lens->radius, k.aperture, 1e-12);
    const int pixels = 1200;
    const CameraRays rays(camera, pixels, pixels, FilterKind::box, 1);
    EXPECT_FALSE(rays.is_pinhole());
    // Where on the film do rays through the point (0, 0, -s) land, that pass the rim of the lens?
    double widest = 0;
    for (int sample = 0; sample < 4096; ++sample) {
      PixelSampler sampler(0, 600, 600, sample);
      const auto [ray, weight] = rays.ray(600, 600, sampler);
      ASSERT_LE(length(ray.origin), camera.thin_lens->radius * (1 + 1e-12));
      // All rays of this pixel meet in the plane in focus.
      const Vec3d in_focus = ray.origin + ray.direction * (k.focus / -ray.direction.z);
      const Vec3d same = k.focus * (rays.corner() + 600.5 * rays.step_x() + 600.5 * rays.step_y());
      ASSERT_LT(length(in_focus - same), 1e-12);
      // By similar triangles the ray through the same point of the lens and (0, 0, -s) lands here:
      const Vec2d on_lens(ray.origin);
      const Vec2d across = on_lens * (1 - k.focus / k.s);
      widest = std::max(widest, 2 * length(across) * film / k.focus);
    }
    EXPECT_NEAR(widest, k.c, 1e-3 * k.c);
    EXPECT_LE(widest, k.c * (1 + 1e-12));
  }
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
