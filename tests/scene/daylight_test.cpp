#include "penumbra/scene/daylight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace penumbra {
namespace {

using std::numbers::pi;

constexpr double degree = pi / 180;

DaylightOptions at(double elevation, double turbidity) {
  return {.elevation = elevation * degree, .azimuth = 90 * degree, .turbidity = turbidity, .width = 256};
}

double lux(const DirectionalLight& sun) { return 683.0 * luminance(sun.irradiance); }

TEST(Daylight, TheSunStandsWhereItIsTold) {
  const Vec3d east = sun_direction(at(30, 3));
  EXPECT_NEAR(east.x, std::cos(30 * degree), 1e-12);
  EXPECT_NEAR(east.y, 0.5, 1e-12);
  EXPECT_NEAR(east.z, 0, 1e-12);
  const Vec3d north = sun_direction({.elevation = 0, .azimuth = 0});
  EXPECT_NEAR(north.z, -1, 1e-12);
  EXPECT_NEAR(dot(make_daylight(at(30, 3)).sun.direction, east), -1, 1e-12);
}

// The zenith is the model's own, from the formula of the paper evaluated by hand for 45 degrees and turbidity 3.
TEST(Daylight, LuminanceOfTheZenith) {
  const double chi = (4.0 / 9 - 3.0 / 120) * (pi - 2 * 45 * degree);
  const double cd = 1000 * ((4.0453 * 3 - 4.9710) * std::tan(chi) - 0.2155 * 3 + 2.4192);
  EXPECT_NEAR(683 * luminance(sky_radiance(at(45, 3), {0, 1, 0})), cd, 2e-3 * cd);
}

// The sun outside the atmosphere gives about 130 klx; a clear sky leaves what the luminous extinction of clear air of
// about 0.21 (Illuminating Engineering Society, 1984) says, within an eighth.
TEST(Daylight, IlluminanceOfTheSun) {
  for (const double elevation : {20.0, 40.0, 60.0, 85.0}) {
    const double mass = 1 / std::sin(elevation * degree);
    EXPECT_NEAR(lux(make_daylight(at(elevation, 2)).sun), 133800 * std::exp(-0.21 * mass),
                0.125 * 133800 * std::exp(-0.21 * mass))
        << elevation;
  }
}

TEST(Daylight, LowAndHazySunsAreWeakerAndRedder) {
  const auto red_over_blue = [](const DirectionalLight& sun) { return sun.irradiance.x / sun.irradiance.z; };
  const DirectionalLight high = make_daylight(at(60, 3)).sun, low = make_daylight(at(5, 3)).sun,
                         hazy = make_daylight(at(60, 8)).sun;
  EXPECT_LT(lux(low), 0.4 * lux(high));
  EXPECT_LT(lux(hazy), lux(high));
  EXPECT_GT(red_over_blue(low), 2 * red_over_blue(high));
  EXPECT_GT(red_over_blue(hazy), red_over_blue(high));
}

// A clear sky alone lights the ground by some 10 to 20 klx, and this model is known to be on the bright side (Zotti,
// Wilkie & Purgathofer 2007); it is blue, and brighter near the sun.
TEST(Daylight, SkylightIsBlueAndBrightAroundTheSun) {
  const DaylightOptions clear = at(45, 2.5);
  const Rgb away = sky_radiance(clear, normalize(Vec3d(-1, 1, 0)));
  EXPECT_GT(away.z, 1.5F * away.x);
  EXPECT_GT(luminance(sky_radiance(clear, normalize(Vec3d(1, 1.2, 0)))), 2 * luminance(away));
  double lux_of_sky = 0;
  constexpr int n = 60;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double y = std::sqrt((i + 0.5) / n), r = std::sqrt(1 - y * y), phi = 2 * pi * (j + 0.5) / n;
      lux_of_sky += 683.0 * luminance(sky_radiance(clear, {r * std::cos(phi), y, r * std::sin(phi)})) * pi / (n * n);
    }
  }
  EXPECT_GT(lux_of_sky, 7000);
  EXPECT_LT(lux_of_sky, 30000);
}

// The ground below sends back its albedo of what falls on it, by the picture's own light.
TEST(Daylight, GroundIsLitByBoth) {
  DaylightOptions options = at(50, 3);
  const Daylight day = make_daylight(options);
  const auto& texels = std::get<std::vector<float>>(day.sky.texels);
  ASSERT_EQ(texels.size(), std::size_t{256 * 128 * 3});
  double irradiance = luminance(day.sun.irradiance) * std::sin(50 * degree);
  for (int y = 0; y < 64; ++y) {
    const double theta = pi * (y + 0.5) / 128;
    for (int x = 0; x < 256; ++x) {
      const float* t = texels.data() + 3 * (y * 256 + x);
      irradiance += luminance(Rgb(t[0], t[1], t[2])) * std::sin(theta) * std::cos(theta) * 2 * pi * pi / (256 * 128);
    }
  }
  const float* ground = texels.data() + 3 * (100 * 256 + 17);
  EXPECT_NEAR(luminance(Rgb(ground[0], ground[1], ground[2])), 0.2 * irradiance / pi, 1e-4 * irradiance);
}

TEST(Daylight, OptionsOutOfRangeAreRefused) {
  EXPECT_THROW((void)make_daylight(at(-5, 3)), std::invalid_argument);
  EXPECT_THROW((void)make_daylight(at(95, 3)), std::invalid_argument);
  EXPECT_THROW((void)make_daylight(at(45, 1)), std::invalid_argument);
  EXPECT_THROW((void)make_daylight(at(45, 30)), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
