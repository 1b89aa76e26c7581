#include "penumbra/render/filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra {
namespace {

using std::numbers::pi;

constexpr int steps = 512;

// Mitchell & Netravali 1988, eq. 8, with B = C = 1/3.
double mitchell(double x) {
  x = std::abs(x);
  if (x < 1) return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
  if (x < 2) return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
  return 0;
}

// Harris 1978, the minimum 4-term window.
double blackman_harris(double x, double radius) {
  const double t = (x + radius) / (2 * radius);
  return 0.35875 - 0.48829 * std::cos(2 * pi * t) + 0.14128 * std::cos(4 * pi * t) - 0.01168 * std::cos(6 * pi * t);
}

}  // namespace

double Filter::radius(FilterKind kind) {
  switch (kind) {
    case FilterKind::box:
      return 0.5;
    case FilterKind::tent:
      return 1;
    case FilterKind::gaussian:
      return 1.5;
    case FilterKind::mitchell:
      return 2;
    case FilterKind::blackman_harris:
      return 1.5;
  }
  return 0.5;
}

double Filter::value(FilterKind kind, double x) {
  const double r = radius(kind);
  if (std::abs(x) > r) return 0;
  switch (kind) {
    case FilterKind::box:
      return 1;
    case FilterKind::tent:
      return 1 - std::abs(x);
    // Lowered to 0 at its end, so that it stops without a step.
    case FilterKind::gaussian:
      return std::exp(-2 * x * x) - std::exp(-2 * r * r);
    case FilterKind::mitchell:
      return mitchell(x);
    case FilterKind::blackman_harris:
      return blackman_harris(x, r);
  }
  return 0;
}

Filter::Filter(FilterKind kind) : kind_(kind), radius_(radius(kind)) {
  if (kind == FilterKind::box) return;
  cdf_.assign(steps + 1, 0);
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double f = value(kind, radius_ * (2 * (i + 0.5) / steps - 1));
    sum += f;
    cdf_[static_cast<std::size_t>(i) + 1] = cdf_[static_cast<std::size_t>(i)] + std::abs(f);
  }
  gain_ = static_cast<float>(cdf_.back() / sum);
  const double total = cdf_.back();
  for (double& c : cdf_) c /= total;
}

Filter::Axis Filter::sample_axis(double u) const {
  if (kind_ == FilterKind::box) return {u - 0.5, 1};
  const auto above = std::upper_bound(cdf_.begin(), cdf_.end(), u);
  const auto cell = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - cdf_.begin() - 1, 0, steps - 1));
  const double part = (u - cdf_[cell]) / std::max(1e-300, cdf_[cell + 1] - cdf_[cell]);
  const double x = radius_ * (2 * (static_cast<double>(cell) + part) / steps - 1);
  return {x, value(kind_, x) < 0 ? -gain_ : gain_};
}

Filter::Position Filter::sample(const Vec2d& u) const {
  const Axis x = sample_axis(u.x);
  const Axis y = sample_axis(u.y);
  return {{x.offset, y.offset}, x.weight * y.weight};
}

}  // namespace penumbra
