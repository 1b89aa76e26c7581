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
  /// A wavelength's colour, and the spectra of red, green, blue and white there; linear between whole nm.
  struct Light {
    Vec3d matching{0}, uplift{0};
    double white = 0;
  };
  std::vector<double> cdf = std::vector<double>(cells + 1, 0.0);
  std::vector<Light> light = std::vector<Light>(cells + 1);  // at whole nm
  std::array<int, 1024> first_cell{};                        // the cell that holds each 1024th of the cdf

  Sensor() {
    for (int i = 0; i <= cells; ++i) {
      const double nm = shortest_visible + i;
      light[i] = {rec709_matching(nm), uplift_basis(nm), white_radiance(nm)};
    }
    move_three();
    constexpr double even_share = 0.005;
    for (int i = 0; i <= cells; ++i) cdf[i] = (1 - even_share) * cdf[i] + even_share * i / cells;
    for (std::size_t k = 0; k < first_cell.size(); ++k) {
      const auto above = std::upper_bound(cdf.begin(), cdf.end(), static_cast<double>(k) / first_cell.size());
      first_cell[k] = std::clamp<int>(static_cast<int>(above - cdf.begin()) - 1, 0, cells - 1);
    }
  }

  /// The last cell that begins at or before the share `v` of all wavelengths, 0 <= v < 1.
  [[nodiscard]] int cell_of(double v) const {
    int cell = first_cell[static_cast<std::size_t>(v * first_cell.size())];
    while (cell < cells - 1 && cdf[cell + 1] <= v) ++cell;
    return cell;
  }

  [[nodiscard]] Light at(int cell, double part) const {
    const Light &a = light[cell], &b = light[cell + 1];
    return {a.matching + part * (b.matching - a.matching), a.uplift + part * (b.uplift - a.uplift),
            a.white + part * (b.white - a.white)};
  }
  [[nodiscard]] Light at(double wavelength) const {
    const double nm = wavelength - shortest_visible;
    const int cell = std::clamp(static_cast<int>(nm), 0, cells - 1);
    return at(cell, nm - cell);
  }

 private:
  [[nodiscard]] Vec3d speeds(const Vec3d& l) const {
    const auto colour = [&](double nm) {
      const Light there = at(nm);
      return there.white * there.matching;
    };
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
    const int cell = eye.cell_of(v);
    const double density = eye.cdf[cell + 1] - eye.cdf[cell];  // per nm
    const double part = std::min((v - eye.cdf[cell]) / density, 1.0);
    const Sensor::Light light = eye.at(cell, part);
    bands.wavelengths_[k] = shortest_visible + cell + part;
    bands.sensor_[k] = Vec3f(light.matching / (3 * density));
    for (int colour = 0; colour < 3; ++colour) bands.uplift_[colour][k] = static_cast<float>(light.uplift[colour]);
    bands.white_[k] = static_cast<float>(light.white);
  }
  return bands;
}

Bands Bands::shifted_to(const std::array<double, 3>& wavelengths) const {
  Bands shifted = *this;
  shifted.wavelengths_ = wavelengths;
  for (int k = 0; k < 3; ++k) {
    const Vec3d basis = uplift_basis(wavelengths[k]);
    for (int colour = 0; colour < 3; ++colour) shifted.uplift_[colour][k] = static_cast<float>(basis[colour]);
    shifted.white_[k] = static_cast<float>(white_radiance(wavelengths[k]));
  }
  return shifted;
}

}  // namespace penumbra
