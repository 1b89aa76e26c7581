#pragma once

#include "penumbra/math/vec.h"

namespace penumbra {

/// How a medium scatters, after Henyey & Greenstein 1941:
///
///     p(mu) = (1 - g^2) / (4 pi (1 + g^2 - 2 g mu)^(3/2)),
///
/// a density over solid angle (1/sr, 1 over the sphere); mu is the cosine between the ways of the light before and
/// after, 1 forward; g is its mean. Symmetric in both ways, so that paths may be followed from either end.
class HenyeyGreenstein {
 public:
  /// @pre -1 < g < 1.
  explicit HenyeyGreenstein(double g) : g_(g) {}

  [[nodiscard]] double value(double mu) const;
  /// The inverse of the cumulative distribution of mu, at `xi` in 0..1: -1 at 0, 1 at 1.
  [[nodiscard]] double cosine(double xi) const;
  /// A direction with density value(mu). @param forward unit, the way before.
  [[nodiscard]] Vec3d sample(const Vec3d& forward, const Vec2d& u) const;

 private:
  double g_;
};

}  // namespace penumbra
