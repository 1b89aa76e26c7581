#include "penumbra/render/aperture_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "penumbra/math/sobol.h"

namespace penumbra {
namespace {

using std::numbers::pi;

struct Moments {
  double passed = 0;  // share
  Vec2d mean{0};
  double square = 0;  // mean of the squared distance from the middle
};

Moments moments(const ApertureSampler& sampler, const Vec2d& at = Vec2d(0)) {
  constexpr std::uint32_t n = 1U << 16;
  Moments m;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto p = sampler.sample(owen_sobol_2d(i, 7), at);
    if (!p) continue;
    m.passed += 1;
    m.mean += *p;
    m.square += dot(*p, *p);
  }
  m.mean /= m.passed;
  m.square /= m.passed;
  m.passed /= n;
  return m;
}

TEST(ApertureSampler, FillsADiskEvenly) {
  const Moments m = moments(ApertureSampler({.radius = 1}));
  EXPECT_EQ(m.passed, 1);
  EXPECT_LT(length(m.mean), 1e-4);
  EXPECT_NEAR(m.square, 0.5, 1e-4);
}

// The mean squared distance from the middle of a regular polygon with circumradius 1: (2 + cos(2 pi / n)) / 6.
TEST(ApertureSampler, FillsAnIrisEvenlyAndTurnsIt) {
  for (const int blades : {3, 5, 6, 9}) {
    const double turn = 0.3;
    const ApertureSampler sampler({.radius = 1, .focus = 1, .aperture = BladeAperture{blades, turn}});
    const Moments m = moments(sampler);
    EXPECT_LT(length(m.mean), 1e-3) << blades;
    EXPECT_NEAR(m.square, (2 + std::cos(2 * pi / blades)) / 6, 1e-3) << blades;
    // No point lies beyond the edges; some lie in every corner.
    const double apothem = std::cos(pi / blades);
    double farthest = 0;
    for (std::uint32_t i = 0; i < 20000; ++i) {
      const Vec2d p = *sampler.sample(owen_sobol_2d(i, 1), Vec2d(0));
      for (int k = 0; k < blades; ++k) {
        const double angle = pi / 2 + turn + 2 * pi * (k + 0.5) / blades;
        ASSERT_LE(p.x * std::cos(angle) + p.y * std::sin(angle), apothem + 1e-12);
      }
      farthest = std::max(farthest, p.x * std::cos(pi / 2 + turn) + p.y * std::sin(pi / 2 + turn));
    }
    EXPECT_GT(farthest, 0.97);
  }
}

TEST(ApertureSampler, FollowsAPictureTopUp) {
  // Bright in the top left and half as bright in the bottom right quarter.
  TextureImage picture{.name = "", .width = 2, .height = 2, .channels = 1, .texels = std::vector<float>{1, 0, 0, 0.5F}};
  const ApertureSampler sampler({.radius = 1, .focus = 1, .aperture = ImageAperture{picture}});
  int top_left = 0, bottom_right = 0;
  constexpr int n = 1 << 14;
  for (int i = 0; i < n; ++i) {
    const Vec2d p = *sampler.sample(owen_sobol_2d(static_cast<std::uint32_t>(i), 1), Vec2d(0));
    top_left += p.x < 0 && p.y > 0 ? 1 : 0;
    bottom_right += p.x > 0 && p.y < 0 ? 1 : 0;
  }
  EXPECT_EQ(top_left + bottom_right, n);
  EXPECT_NEAR(top_left, n * 2.0 / 3, 5);
}

// In a corner the second rim leaves the lens where two disks overlap, as far apart as asked.
TEST(ApertureSampler, ACatsEyeIsTheOverlapOfTwoDisks) {
  const double apart = 0.8;
  const ApertureSampler sampler({.radius = 1, .focus = 1, .aperture = DiskAperture{}, .cat_eye = apart});
  const Vec2d corner(0.6, 0.8);
  const Moments m = moments(sampler, corner);
  const double overlap = 2 * std::acos(apart / 2) - apart / 2 * std::sqrt(4 - apart * apart);
  EXPECT_NEAR(m.passed, overlap / pi, 1e-3);
  EXPECT_LT(length(m.mean - apart / 2 * corner), 1e-3);
  EXPECT_EQ(moments(sampler).passed, 1);
}

TEST(ApertureSampler, RefusesWhatLetsNoLightThrough) {
  const auto make = [](const ThinLens& lens) { return ApertureSampler(lens); };
  TextureImage black{.name = "", .width = 1, .height = 1, .channels = 1, .texels = std::vector<float>{0}};
  EXPECT_THROW(make({.radius = 1, .focus = 1, .aperture = ImageAperture{black}}), std::invalid_argument);
  EXPECT_THROW(make({.radius = 1, .focus = 1, .aperture = BladeAperture{2}}), std::invalid_argument);
  EXPECT_THROW(make({.radius = 1, .focus = 0}), std::invalid_argument);
  EXPECT_THROW(make({.radius = 1, .focus = 1, .aperture = DiskAperture{}, .cat_eye = 2}), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
