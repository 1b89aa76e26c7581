#include "penumbra/tracing/shading/phase_function.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/math/frame.h"

namespace penumbra {

using std::numbers::pi;

double HenyeyGreenstein::value(double mu) const {
  const double base = 1 + g_ * g_ - 2 * g_ * mu;
  return (1 - g_ * g_) / (4 * pi * base * std::sqrt(base));
}

double HenyeyGreenstein::cosine(double xi) const {
  const double even = 2 * xi - 1;
  // The closed form divides by g; to first order there.
  if (std::abs(g_) < 1e-5) return even + 1.5 * g_ * (1 - even * even);
  const double root = (1 - g_ * g_) / (1 + g_ * even);
  return std::clamp((1 + g_ * g_ - root * root) / (2 * g_), -1.0, 1.0);
}

Vec3d HenyeyGreenstein::sample(const Vec3d& forward, const Vec2d& u) const {
  const double mu = cosine(u.x);
  const double sine = std::sqrt(std::max(0.0, 1 - mu * mu));
  return Frame(forward).to_world({sine * std::cos(2 * pi * u.y), sine * std::sin(2 * pi * u.y), mu});
}

}  // namespace penumbra
