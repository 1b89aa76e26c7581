#include "penumbra/tracing/shading/microfacet.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra {

using std::numbers::pi;

double Ggx::distribution(const Vec3d& h) const {
  if (h.z <= 0) return 0;
  // Walter et al. eq. 33 with tan written as sin/cos: no cancellation near the pole, no overflow at the horizon.
  const double stretch = h.x * h.x + h.y * h.y + alpha_ * alpha_ * h.z * h.z;
  return alpha_ * alpha_ / (pi * stretch * stretch);
}

double Ggx::lambda(const Vec3d& w) const {
  const double tan_2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  const double slope_2 = alpha_ * alpha_ * tan_2;
  if (std::isinf(slope_2)) return slope_2;              // w on the horizon
  return 0.5 * slope_2 / (1 + std::sqrt(1 + slope_2));  // (sqrt(1 + s) - 1)/2 without cancellation
}

Vec3d Ggx::sample_visible_normal(const Vec3d& wo, const Vec2d& u) const {
  const Vec3d stretched = glm::normalize(Vec3d(alpha_ * wo.x, alpha_ * wo.y, wo.z));
  const double phi = 2 * pi * u.x;
  const double z = (1 - u.y) * (1 + stretched.z) - stretched.z;
  const double r = std::sqrt(std::clamp(1 - z * z, 0.0, 1.0));
  const Vec3d h = Vec3d(r * std::cos(phi), r * std::sin(phi), z) + stretched;
  return glm::normalize(Vec3d(alpha_ * h.x, alpha_ * h.y, std::max(0.0, h.z)));
}

double Ggx::visible_normal_pdf(const Vec3d& wo, const Vec3d& h) const {
  return masking(wo) * distribution(h) * std::max(0.0, glm::dot(wo, h)) / std::abs(wo.z);
}

}  // namespace penumbra
