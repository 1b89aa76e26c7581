#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// Integral over the unit sphere by the midpoint rule in polar angle and azimuth about z, `steps` polar rows, twice as
/// many columns. The equator is the edge of a row, so that a jump there costs no accuracy when `steps` is even.
template <class Integrand>
auto integrate_over_sphere(int steps, Integrand&& f) -> decltype(f(Vec3d(0))) {
  const double step = std::numbers::pi / steps;
  decltype(f(Vec3d(0))) sum(0);
  for (int i = 0; i < steps; ++i) {
    const double theta = (i + 0.5) * step;
    // The exact solid angle of the cell.
    const double cell = (std::cos(i * step) - std::cos((i + 1) * step)) * step;
    for (int j = 0; j < 2 * steps; ++j) {
      const double phi = (j + 0.5) * step;
      const Vec3d w(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      sum += f(w) * static_cast<decltype(f(Vec3d(0)))>(cell);
    }
  }
  return sum;
}

/// Counts of directions in cells of equal polar angle and azimuth, to be judged against a density.
class SphereHistogram {
 public:
  explicit SphereHistogram(int rows) : rows_(rows), counts_(static_cast<std::size_t>(2 * rows) * rows) {}

  void add(const Vec3d& w) {
    const double row = std::acos(std::clamp(w.z, -1.0, 1.0)) / std::numbers::pi * rows_;
    const double turn = std::atan2(w.y, w.x) / (2 * std::numbers::pi);
    const double column = (turn < 0 ? turn + 1 : turn) * 2 * rows_;
    ++counts_[index(std::min(static_cast<int>(row), rows_ - 1), std::min(static_cast<int>(column), 2 * rows_ - 1))];
  }

  /// Pearson's chi-squared of the counts, and of the `total` trials that gave no direction, against the density, as a
  /// standard normal deviate (Wilson & Hilferty 1931): above 4.5 by chance once in 300,000 tests.
  template <class Density>
  [[nodiscard]] double deviate(double total, Density&& density) const {
    constexpr int sub = 16;
    double chi_squared = 0;
    int cells = 0;
    double pooled_expected = 0;
    double pooled_count = 0;
    double rest_expected = total;
    double rest_count = total;
    const auto judge = [&](double expected, double count) {
      if (expected < 8) {
        pooled_expected += expected;
        pooled_count += count;
        return;
      }
      chi_squared += (count - expected) * (count - expected) / expected;
      ++cells;
    };
    const double step = std::numbers::pi / rows_ / sub;
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < 2 * rows_; ++column) {
        double share = 0;
        for (int i = row * sub; i < (row + 1) * sub; ++i) {
          const double theta = (i + 0.5) * step;
          const double solid_angle = (std::cos(i * step) - std::cos((i + 1) * step)) * step;
          for (int j = column * sub; j < (column + 1) * sub; ++j) {
            const double phi = (j + 0.5) * step;
            share += solid_angle *
                     density(Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
          }
        }
        const double count = counts_[index(row, column)];
        judge(total * share, count);
        rest_expected -= total * share;
        rest_count -= count;
      }
    }
    if (rest_expected > 8) judge(rest_expected, rest_count);
    if (pooled_expected > 0.5) {
      chi_squared += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected;
      ++cells;
    } else if (pooled_count > 10) {
      return 100;  // directions where the density says none can be
    }
    const double k = std::max(1, cells - 1);
    return (std::cbrt(chi_squared / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
  }

 private:
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * 2 * rows_ + column;
  }

  int rows_;
  std::vector<int> counts_;
};

}  // namespace penumbra
