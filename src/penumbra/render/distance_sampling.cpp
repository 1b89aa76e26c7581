#include "penumbra/render/distance_sampling.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

EquiangularDistances::EquiangularDistances(const Ray& ray, const Vec3d& point, const Media::Interval& interval)
    : interval_(interval), middle_(dot(point - ray.origin, ray.direction)) {
  // A ray through the point itself would put all samples there: any distance above 0 keeps the estimate right.
  distance_ = std::max(length(point - ray.at(middle_)), 1e-6 * (1 + std::abs(middle_)));
  angle_from_ = std::atan((interval.from - middle_) / distance_);
  angle_to_ = std::atan((interval.to - middle_) / distance_);
}

double EquiangularDistances::sample(double u) const {
  const double t = middle_ + distance_ * std::tan(angle_from_ + u * (angle_to_ - angle_from_));
  return std::clamp(t, interval_.from, interval_.to);
}

double EquiangularDistances::pdf(double t) const {
  const double off = t - middle_;
  return distance_ / ((angle_to_ - angle_from_) * (distance_ * distance_ + off * off));
}

double ExponentialDistances::sample(double u) const {
  const double length = interval_.to - interval_.from;
  if (!(sigma_ * length > 1e-9)) return interval_.from + u * length;
  return std::min(interval_.to, interval_.from - std::log1p(u * std::expm1(-sigma_ * length)) / sigma_);
}

double ExponentialDistances::pdf(double t) const {
  const double length = interval_.to - interval_.from;
  if (!(sigma_ * length > 1e-9)) return 1 / length;
  return sigma_ * std::exp(-sigma_ * (t - interval_.from)) / -std::expm1(-sigma_ * length);
}

}  // namespace penumbra
