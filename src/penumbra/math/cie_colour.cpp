#include "penumbra/math/cie_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace penumbra {
namespace {

// From 300 nm in steps of 10.
constexpr std::array<double, 54> d65{0.0341,  3.2945,  20.236,  37.0535, 39.9488, 44.9117, 46.6383, 52.0891, 49.9755,
                                     54.6482, 82.7549, 91.486,  93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861,
                                     115.923, 108.811, 109.354, 107.802, 104.790, 107.689, 104.405, 104.046, 100.000,
                                     96.3342, 95.7880, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268,
                                     80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.3490, 61.6040, 69.8856, 75.0870,
                                     63.5927, 46.4182, 66.8054, 63.3828, 64.3040, 59.4519, 51.9590, 57.4406, 60.3125};
constexpr double d65_first = 300, d65_step = 10;

// A Gaussian of another width on each side.
double lobe(double wavelength, double mean, double below, double above) {
  const double t = (wavelength - mean) / (wavelength < mean ? below : above);
  return std::exp(-0.5 * t * t);
}

// From CIE XYZ to linear Rec. 709, by the primaries and the white of ITU-R BT.709-6 (item 1.3, 1.4).
Mat3d xyz_to_rec709() {
  const auto column = [](double x, double y) { return Vec3d(x, y, 1 - x - y); };
  const Mat3d primaries(column(0.64, 0.33), column(0.30, 0.60), column(0.15, 0.06));
  const Vec3d white = column(0.3127, 0.3290) / 0.3290;
  const Vec3d amounts = glm::inverse(primaries) * white;
  return glm::inverse(Mat3d(primaries[0] * amounts.x, primaries[1] * amounts.y, primaries[2] * amounts.z));
}

/// What fixes the scales: sums by the midpoint rule over 1 nm, exact to 1e-7 for functions so smooth.
struct Scales {
  Mat3d to_rec709 = xyz_to_rec709();
  Vec3d matching{0};  // of each band
  double white = 0;   // W/(m^2 sr nm) for a value of 1 of D65's table
  Scales() {
    Vec3d seen(0);
    double power = 0;
    for (double nm = shortest_visible + 0.5; nm < longest_visible; nm += 1) {
      seen += illuminant_d65(nm) * (to_rec709 * cie_matching(nm));
      power += illuminant_d65(nm);
    }
    white = 3 / power;
    matching = 1.0 / (white * seen);
  }
};

const Scales& scales() {
  static const Scales made;
  return made;
}

}  // namespace

Vec3d cie_matching(double wavelength) {
  if (wavelength < shortest_visible || wavelength > longest_visible) return Vec3d(0);
  const double x = 1.056 * lobe(wavelength, 599.8, 37.9, 31.0) + 0.362 * lobe(wavelength, 442.0, 16.0, 26.7) -
                   0.065 * lobe(wavelength, 501.1, 20.4, 26.2);
  const double y = 0.821 * lobe(wavelength, 568.8, 46.9, 40.5) + 0.286 * lobe(wavelength, 530.9, 16.3, 31.1);
  const double z = 1.217 * lobe(wavelength, 437.0, 11.8, 36.0) + 0.681 * lobe(wavelength, 459.0, 26.0, 13.8);
  return {x, y, z};
}

double illuminant_d65(double wavelength) {
  const double at = (wavelength - d65_first) / d65_step;
  if (!(at >= 0) || at > static_cast<double>(d65.size() - 1)) return 0;
  const auto cell = std::min(static_cast<std::size_t>(at), d65.size() - 2);
  const double part = at - static_cast<double>(cell);
  return d65[cell] + part * (d65[cell + 1] - d65[cell]);
}

Vec3d rec709_matching(double wavelength) { return scales().matching * (scales().to_rec709 * cie_matching(wavelength)); }

double white_radiance(double wavelength) {
  if (wavelength < shortest_visible || wavelength > longest_visible) return 0;
  return scales().white * illuminant_d65(wavelength);
}

}  // namespace penumbra
