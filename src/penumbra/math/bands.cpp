#include "penumbra/math/bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "penumbra/math/cie_colour.h"
#include "penumbra/math/uplift.h"

namespace penumbra {
namespace {

constexpr int cells = 400;  // of 1 nm
static_assert(cells == static_cast<int>(longest_visible - shortest_visible));

// Where the second and the third of three wavelengths begin that, moved upwards together, mix to white all the way: in
// the end each arrives where the next began (found by trying; the equations below have this one solution).
constexpr double second_begins = 486, third_begins = 579.9;

/// Density of wavelengths and what light of each looks like, in cells of 1 nm.
///
/// Three wavelengths l_k(v) are moved through their thirds of the range so that white light leaves no noise at all:
/// for every v the three together are exactly white,
///
///     sum over k of  white(l_k) matching(l_k) dl_k/dv = (1, 1, 1),
///
/// three linear equations for the three speeds. White must lie between the three colours: it does for no other start.
/// The density of wavelengths is 1 / (3 dl/dv). Cells get 0.5 % of it evenly, for light where white has none.
struct Sensor {
  std::vector<double> cdf = std::vector<double>(cells + 1, 0.0);
  std::vector<Vec3d> matching = std::vector<Vec3d>(cells + 1);  // at whole nm

  Sensor() {
    for (int i = 0; i <= cells; ++i) matching[i] = rec709_matching(shortest_visible + i);
    move_three();
    constexpr double even_share = 0.005;
    for (int i = 0; i <= cells; ++i) cdf[i] = (1 - even_share) * cdf[i] + even_share * i / cells;
  }

  [[nodiscard]] Vec3d matching_at(double wavelength) const {
    const double at = wavelength - shortest_visible;
    const int cell = std::clamp(static_cast<int>(at), 0, cells - 1);
    return matching[cell] + (at - cell) * (matching[cell + 1] - matching[cell]);
  }

 private:
  [[nodiscard]] Vec3d speeds(const Vec3d& l) const {
    const auto colour = [&](double nm) { return white_radiance(nm) * matching_at(nm); };
    return glm::inverse(Mat3d(colour(l.x), colour(l.y), colour(l.z))) * Vec3d(1);
  }

  // By the midpoint rule; writes the time at which each whole nm is passed into the cdf.
  void move_three() {
    constexpr double step = 1.0 / 2000, longest_way = 0.2;  // of the time; nm
    const std::array<double, 4> begins{shortest_visible, second_begins, third_begins, longest_visible};
    Vec3d l(begins[0], begins[1], begins[2]);
    double v = 0;
    while (v < 1 && l.x < begins[1] && l.y < begins[2] && l.z < longest_visible - 0.5) {
      const Vec3d speed = speeds(l);
      const double dv = std::min(step, longest_way / std::max({speed.x, speed.y, speed.z}));
      const Vec3d moved = l + dv * speeds(l + dv / 2 * speed);
      for (int k = 0; k < 3; ++k) note(l[k], moved[k], v, dv);
      l = moved;
      v += dv;
    }
    // Rounding ends the way a little early or late; what is left of each third is passed at once.
    for (int i = 1; i <= cells; ++i) {
      const double nm = shortest_visible + i;
      const int third = nm > begins[2] ? 2 : nm > begins[1] ? 1 : 0;
      cdf[i] = (third + (nm > l[third] ? 1.0 : cdf[i] / v)) / 3;
    }
  }

  void note(double from, double to, double v, double dv) {
    for (int i = static_cast<int>(std::ceil(from - shortest_visible)); i <= to - shortest_visible && i <= cells; ++i) {
      const double part = (shortest_visible + i - from) / (to - from);
      cdf[i] = v + part * dv;
    }
  }
};

const Sensor& sensor() {
  static const Sensor made;
  return made;
}

}  // namespace

Bands Bands::sample(double u) {
  const Sensor& eye = sensor();
  Bands bands;
  bands.spectral_ = true;
  for (int k = 0; k < 3; ++k) {
    double v = u + k / 3.0;
    v -= std::floor(v);
    const auto above = std::upper_bound(eye.cdf.begin(), eye.cdf.end(), v);
    const auto cell = std::clamp<int>(static_cast<int>(above - eye.cdf.begin()) - 1, 0, cells - 1);
    const double density = eye.cdf[cell + 1] - eye.cdf[cell];  // per nm
    const double wavelength = shortest_visible + cell + std::min((v - eye.cdf[cell]) / density, 1.0);
    bands.wavelengths_[k] = wavelength;
    bands.sensor_[k] = Vec3f(eye.matching_at(wavelength) / (3 * density));
  }
  bands.look_up();
  return bands;
}

Bands Bands::shifted_to(const std::array<double, 3>& wavelengths) const {
  Bands shifted = *this;
  shifted.wavelengths_ = wavelengths;
  shifted.look_up();
  return shifted;
}

void Bands::look_up() {
  for (int k = 0; k < 3; ++k) {
    const Vec3d basis = uplift_basis(wavelengths_[k]);
    for (int colour = 0; colour < 3; ++colour) uplift_[colour][k] = static_cast<float>(basis[colour]);
    white_[k] = static_cast<float>(white_radiance(wavelengths_[k]));
  }
}

}  // namespace penumbra
