#pragma once

#include "penumbra/math/vec.h"

namespace penumbra {

/// The directions between three great circles: a triangle as it is seen from a point.
class SphericalTriangle {
 public:
  /// @param a, b, c its corners as seen, unit, in any order; no two opposite each other.
  SphericalTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);

  /// sr, 0 to 2 pi (van Oosterom & Strackee 1983).
  [[nodiscard]] double solid_angle() const { return solid_angle_; }
  /// A unit direction within it, with density 1 / solid_angle(), by stratified numbers in [0, 1)^2 (Arvo 1995).
  [[nodiscard]] Vec3d sample(const Vec2d& u) const;

 private:
  Vec3d a_, b_, c_;
  double solid_angle_ = 0;
  double cos_alpha_ = 1, sin_alpha_ = 0;  // of the angle at a
};

}  // namespace penumbra
