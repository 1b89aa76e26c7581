#pragma once

#include "penumbra/math/ray.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {

/// Distances along a ray in proportion to 1 / (distance to a point)^2: equal angles as seen from that point
/// (Kulla & Fajardo, "Importance Sampling Techniques for Path Tracing in Participating Media", 2012, eq. 6 and 7).
class EquiangularDistances {
 public:
  EquiangularDistances(const Ray& ray, const Vec3d& point, const Media::Interval& interval);

  /// @param u 0..1. In the interval.
  [[nodiscard]] double sample(double u) const;
  /// 1/m; of distances in the interval.
  [[nodiscard]] double pdf(double t) const;

 private:
  Media::Interval interval_;
  double middle_;    ///< where the ray is nearest to the point
  double distance_;  ///< there
  double angle_from_, angle_to_;
};

/// Distances in proportion to exp(-sigma t), cut to an interval: those of a transmittance.
class ExponentialDistances {
 public:
  /// @param sigma 1/m, >= 0; above 0 for an infinite interval.
  ExponentialDistances(double sigma, const Media::Interval& interval) : sigma_(sigma), interval_(interval) {}

  [[nodiscard]] double sample(double u) const;
  [[nodiscard]] double pdf(double t) const;

 private:
  double sigma_;
  Media::Interval interval_;
};

}  // namespace penumbra
