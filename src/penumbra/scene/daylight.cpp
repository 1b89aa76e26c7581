#include "penumbra/scene/daylight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace penumbra {
namespace {

using std::numbers::pi;

constexpr double lumens_per_watt = 683;
constexpr double sun_radius = 0.5 * 0.53 * pi / 180;  // rad, as seen from the earth

/// Perez' function of the angles to zenith and sun.
struct Perez {
  double a, b, c, d, e;
  [[nodiscard]] double operator()(double cos_zenith, double gamma) const {
    const double cos_gamma = std::cos(gamma);
    return (1 + a * std::exp(b / std::max(cos_zenith, 1e-3))) *
           (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

/// Linear Rec. 709 of CIE XYZ (D65 white).
Rgb rec709(double x, double y, double z) {
  const Vec3d rgb(3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                  0.0556434 * x - 0.2040259 * y + 1.0572252 * z);
  return {glm::max(rgb, Vec3d(0))};
}

/// Preetham et al. 1999, appendix A.2, for one sun and turbidity.
class PreethamSky {
 public:
  PreethamSky(double sun_zenith, double turbidity) : sun_zenith_(sun_zenith) {
    const double t = turbidity, s = sun_zenith, s2 = s * s, s3 = s2 * s;
    luminance_ = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                  -0.0670 * t + 0.3703};
    x_ = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989, -0.0033 * t + 0.0452};
    y_ = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537, -0.0109 * t + 0.0529};
    const double chi = (4.0 / 9 - t / 120) * (pi - 2 * s);
    zenith_luminance_ = 1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192);  // cd/m^2
    zenith_x_ = (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s) * t * t +
                (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s + 0.00394) * t +
                (0.11693 * s3 - 0.21196 * s2 + 0.06052 * s + 0.25886);
    zenith_y_ = (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s) * t * t +
                (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s + 0.00516) * t +
                (0.15346 * s3 - 0.26756 * s2 + 0.06670 * s + 0.26688);
  }

  [[nodiscard]] Rgb radiance(double cos_zenith, double gamma) const {
    const auto scaled = [&](const Perez& f, double zenith) {
      return zenith * f(cos_zenith, gamma) / f(1, sun_zenith_);
    };
    const double luminance = std::max(0.0, scaled(luminance_, zenith_luminance_)) / lumens_per_watt;
    const double x = scaled(x_, zenith_x_), y = scaled(y_, zenith_y_);
    return rec709(luminance * x / y, luminance, luminance * (1 - x - y) / y);
  }

 private:
  double sun_zenith_;
  Perez luminance_{}, x_{}, y_{};
  double zenith_luminance_ = 0, zenith_x_ = 0, zenith_y_ = 0;
};

// The sun outside the atmosphere, 100 W/(m^2 nm sr), and absorption of ozone, mixed gases and water vapour, from 380 to
// 750 nm by 10 nm (Preetham et al. 1999, table 2).
constexpr std::array sun_spectrum{165.5, 162.3, 211.2, 258.8, 258.2, 242.3, 267.6, 296.6, 305.4, 300.6,
                                  306.6, 288.3, 287.1, 278.2, 271.0, 272.3, 263.6, 255.0, 250.6, 253.1,
                                  253.5, 251.3, 246.3, 241.7, 236.8, 232.1, 228.2, 223.4, 219.7, 215.3,
                                  211.0, 207.3, 202.4, 198.7, 194.3, 190.7, 186.3, 182.6};
constexpr std::array ozone{0.0,   0.0,   0.0,   0.0,   0.0,   0.0,   0.0,   0.003, 0.006, 0.009, 0.014, 0.021, 0.03,
                           0.04,  0.048, 0.063, 0.075, 0.085, 0.103, 0.12,  0.12,  0.115, 0.125, 0.12,  0.09,  0.067,
                           0.048, 0.036, 0.028, 0.023, 0.018, 0.014, 0.011, 0.01,  0.009, 0.007, 0.004, 0.0};
constexpr double water(double nm) {
  return nm == 690   ? 0.016
         : nm == 700 ? 0.024
         : nm == 710 ? 0.0125
         : nm == 720 ? 1.0
         : nm == 730 ? 0.87
         : nm == 740 ? 0.061
         : nm == 750 ? 0.001
                     : 0;
}

// What the air leaves of direct sunlight. @param um wavelength, micrometres. @param mass relative optical air mass.
double transmittance_of_air(std::size_t step, double mass, double turbidity) {
  const double nm = 380 + 10.0 * static_cast<double>(step), um = nm / 1000;
  const double rayleigh = 0.008735 * std::pow(um, -4.08) * mass;
  const double aerosol = (0.04608 * turbidity - 0.04586) * std::pow(um, -1.3) * mass;
  const double wet = water(nm) * 2.0 * mass;  // 2 cm of precipitable water
  const double vapour = 0.2385 * wet / std::pow(1 + 20.07 * wet, 0.45);
  return std::exp(-rayleigh - aerosol - ozone[step] * 0.35 * mass - vapour);  // 0.35 cm of ozone
}

// Colour matching functions of the CIE 1931 observer, the multi-lobe fit of Wyman, Sloan & Shirley (JCGT 2(2), 2013).
Vec3d colour_matching(double nm) {
  const auto lobe = [nm](double height, double centre, double left, double right) {
    const double t = (nm - centre) * (nm < centre ? left : right);
    return height * std::exp(-0.5 * t * t);
  };
  return {lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) - lobe(0.065, 501.1, 0.0490, 0.0382),
          lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
          lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)};
}

DirectionalLight make_sun(const DaylightOptions& options) {
  // Air mass by Kasten 1965, as the paper has it.
  const double zenith = pi / 2 - options.elevation;
  const double mass = 1 / (std::cos(zenith) + 0.15 * std::pow(93.885 - zenith * 180 / pi, -1.253));
  Vec3d xyz(0);
  for (std::size_t step = 0; step < sun_spectrum.size(); ++step) {
    const double radiance = 100 * sun_spectrum[step] * transmittance_of_air(step, mass, options.turbidity);
    xyz += 10 * radiance * colour_matching(380 + 10.0 * static_cast<double>(step));
  }
  const double sine = std::sin(sun_radius);
  return {.direction = -sun_direction(options),
          .irradiance = rec709(xyz.x, xyz.y, xyz.z) * static_cast<float>(pi * sine * sine),
          .angular_radius = sun_radius};
}

void check(const DaylightOptions& o) {
  const auto require = [](bool ok, const char* sentence) {
    if (!ok) throw std::invalid_argument(sentence);
  };
  require(o.elevation >= 0 && o.elevation <= pi / 2 + 1e-9, "the sun's elevation must lie in 0 to 90 degrees");
  require(std::isfinite(o.azimuth), "the sun's azimuth must be a finite number of degrees");
  require(o.turbidity >= 2 && o.turbidity <= 10, "the turbidity must lie in 2 (very clear) to 10 (hazy)");
  require(o.ground_albedo >= 0 && o.ground_albedo <= 1, "the ground's albedo must lie in 0 to 1");
  require(o.width >= 8 && o.width <= 16384, "a sky's picture must be 8 to 16384 texels wide");
}

}  // namespace

Vec3d sun_direction(const DaylightOptions& options) {
  const double ground = std::cos(options.elevation);
  return {ground * std::sin(options.azimuth), std::sin(options.elevation), -ground * std::cos(options.azimuth)};
}

Rgb sky_radiance(const DaylightOptions& options, const Vec3d& direction) {
  const double gamma = std::acos(std::clamp(dot(direction, sun_direction(options)), -1.0, 1.0));
  return PreethamSky(pi / 2 - options.elevation, options.turbidity).radiance(direction.y, gamma);
}

Daylight make_daylight(const DaylightOptions& options) {
  check(options);
  const PreethamSky sky(pi / 2 - options.elevation, options.turbidity);
  const Vec3d sun = sun_direction(options);
  const int width = options.width, height = width / 2;
  Daylight made{.sky = {.name = "sky", .width = width, .height = height, .channels = 3, .texels = {}},
                .sun = make_sun(options)};
  std::vector<float> texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  const auto texel = [&](int x, int y) {
    return texels.data() +
           3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  };
  Vec3d on_ground = Vec3d(made.sun.irradiance) * sun.y;  // irradiance, W/m^2
  for (int y = 0; y < height / 2; ++y) {
    const double theta = pi * (y + 0.5) / height;
    const double solid_angle = 2 * pi * pi / (static_cast<double>(width) * height) * std::sin(theta);
    for (int x = 0; x < width; ++x) {
      const double phi = 2 * pi * ((x + 0.5) / width - 0.5);
      const Vec3d way(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi));
      const Rgb radiance = sky.radiance(way.y, std::acos(std::clamp(dot(way, sun), -1.0, 1.0)));
      std::copy_n(&radiance.x, 3, texel(x, y));
      on_ground += Vec3d(radiance) * (solid_angle * way.y);
    }
  }
  const Rgb ground(on_ground * (options.ground_albedo / pi));
  for (int y = height / 2; y < height; ++y) {
    for (int x = 0; x < width; ++x) std::copy_n(&ground.x, 3, texel(x, y));
  }
  made.sky.texels = std::move(texels);
  return made;
}

}  // namespace penumbra
