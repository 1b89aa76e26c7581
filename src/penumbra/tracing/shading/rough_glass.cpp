#include "penumbra/tracing/shading/rough_glass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/tracing/shading/fresnel.h"
#include "penumbra/tracing/shading/rough_glass_table.h"

namespace penumbra {
namespace {

using std::numbers::pi;

constexpr double least_roughness = 0.03162277660168379;  // GGX width 0.001
constexpr double largest_ior = 3;

/// Polynomial interpolation between the zeros of a Chebyshev polynomial in 0..1, by the barycentric formula (Berrut &
/// Trefethen 2004).
template <int count>
class Chebyshev {
 public:
  Chebyshev() {
    for (int k = 0; k < count; ++k) {
      const double angle = pi * (k + 0.5) / count;
      nodes_[k] = 0.5 - 0.5 * std::cos(angle);
      weights_[k] = (k % 2 == 0 ? 1 : -1) * std::sin(angle);
    }
  }
  /// What each node's value counts for at `x`.
  [[nodiscard]] std::array<double, count> shares(double x) const {
    std::array<double, count> shares{};
    double sum = 0;
    for (int k = 0; k < count; ++k) {
      const double way = x - nodes_[k];
      if (std::abs(way) < 1e-14) {
        shares.fill(0);
        shares[k] = 1;
        return shares;
      }
      sum += shares[k] = weights_[k] / way;
    }
    for (double& s : shares) s /= sum;
    return shares;
  }

 private:
  std::array<double, count> nodes_{}, weights_{};
};

const Chebyshev<rough_glass_table::indices> over_index;
const Chebyshev<rough_glass_table::roughnesses> over_roughness;
const Chebyshev<rough_glass_table::cosines> over_cosine;

// Coordinates in which the table is smooth, each from 0 to 1.

/// Of the index: 0 without contrast.
double index_coordinate(double ior) { return std::sqrt(2 * (ior - 1) / (ior + 1)); }

/// Of the cosine: what happens near grazing happens within a few times alpha.
double cosine_coordinate(double c, double alpha) { return std::sqrt(c * (1 + alpha) / (c + alpha)); }
double cosine_of(double x, double alpha) {
  const double q = x * x / (1 + alpha);
  return alpha * q / (1 - q);
}

/// Points of Gauss & Legendre's rule in 0..1, and what each node of the cosine's coordinate counts for there.
class Hemisphere {
 public:
  static constexpr int points = 24;

  Hemisphere() {
    for (int i = 0; i < points; ++i) {
      double x = std::cos(pi * (i + 0.75) / (points + 0.5));
      double slope = 0;
      for (int step = 0; step < 50; ++step) {  // Newton, from a start that is good to 1e-3
        double before = 1, now = x;
        for (int n = 2; n <= points; ++n) {
          const double next = ((2 * n - 1) * x * now - (n - 1) * before) / n;
          before = now;
          now = next;
        }
        slope = points * (x * now - before) / (x * x - 1);
        x -= now / slope;
      }
      at_[i] = 0.5 + 0.5 * x;
      weight_[i] = 1 / ((1 - x * x) * slope * slope);
      shares_[i] = over_cosine.shares(at_[i]);
    }
  }
  /// 2 x the integral of a function of the cosine, given at the nodes, times the cosine.
  [[nodiscard]] double mean(const std::array<float, RoughGlass::nodes>& values, double alpha) const {
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      const double x = at_[i], q = x * x / (1 + alpha);
      const double slope = alpha / ((1 - q) * (1 - q)) * 2 * x / (1 + alpha);  // of cosine_of
      double value = 0;
      for (int k = 0; k < RoughGlass::nodes; ++k) value += shares_[i][k] * values[k];
      sum += weight_[i] * 2 * cosine_of(x, alpha) * slope * value;
    }
    return sum;
  }

 private:
  std::array<double, points> at_{}, weight_{};
  std::array<std::array<double, RoughGlass::nodes>, points> shares_{};
};

const Hemisphere hemisphere;

}  // namespace

RoughGlass::RoughGlass(double roughness, double ior) {
  static_assert(nodes == rough_glass_table::cosines);
  const double r = std::clamp(roughness, least_roughness, 1.0);
  const double n = std::clamp(ior, 1.0, largest_ior);
  alpha_ = r * r;
  const auto by_index = over_index.shares(index_coordinate(n));
  const auto by_roughness = over_roughness.shares((r - least_roughness) / (1 - least_roughness));
  for (int side = 0; side < 2; ++side) {
    std::array<double, nodes> sum{};
    for (int i = 0; i < rough_glass_table::indices; ++i) {
      for (int j = 0; j < rough_glass_table::roughnesses; ++j) {
        const double share = by_index[i] * by_roughness[j] * 1e-4;
        const auto& row =
            rough_glass_table::lost[(side * rough_glass_table::indices + i) * rough_glass_table::roughnesses + j];
        for (int k = 0; k < nodes; ++k) sum[k] += share * row[k];
      }
    }
    for (int k = 0; k < nodes; ++k) sides_[side].lost[k] = static_cast<float>(sum[k]);
    sides_[side].mean = std::max(0.0, hemisphere.mean(sides_[side].lost, alpha_));
  }
  // n^2 (1 - reflected) mean must be the same on both sides for reciprocity; diffuse Fresnel terms F have that of
  // n^2 (1 - F).
  const double least = std::min(sides_[0].mean, sides_[1].mean);
  const double through[2] = {1 - fresnel_diffuse_external(n), 1 - fresnel_diffuse_internal(n)};
  for (int side = 0; side < 2; ++side) {
    if (sides_[side].mean > 0) sides_[side].reflected = 1 - through[side] * least / sides_[side].mean;
  }
}

double RoughGlass::lost(bool outside, double cos_theta) const {
  const auto shares = over_cosine.shares(cosine_coordinate(std::clamp(cos_theta, 0.0, 1.0), alpha_));
  const auto& values = sides_[outside ? 0 : 1].lost;
  double sum = 0;
  for (int k = 0; k < nodes; ++k) sum += shares[k] * values[k];
  return std::max(0.0, sum);
}

}  // namespace penumbra
