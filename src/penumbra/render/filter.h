#pragma once

#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/render/render.h"

namespace penumbra {

/// A reconstruction filter, used by drawing sample positions from it (Ernst, Stamminger & Greiner 2006): each sample
/// then belongs to one pixel, so tiles share nothing and threads never meet.
///
/// box: 1 pixel wide. tent, gaussian (sigma 0.5), mitchell (B = C = 1/3) and blackman_harris: 4, 3, 4 and 3 pixels
/// wide.
class Filter {
 public:
  explicit Filter(FilterKind kind);

  struct Position {
    Vec2d offset;  ///< from the pixel's centre, pixels
    float weight;  ///< 1, or -1 in a negative lobe, times the filter's integral of |f| over that of f
  };
  [[nodiscard]] Position sample(const Vec2d& u) const;

  /// The filter itself at a distance from the centre along one axis, not normalised.
  [[nodiscard]] static double value(FilterKind kind, double x);
  /// Half its width, pixels.
  [[nodiscard]] static double radius(FilterKind kind);

 private:
  struct Axis {
    double offset;
    float weight;
  };
  [[nodiscard]] Axis sample_axis(double u) const;

  FilterKind kind_;
  double radius_;
  float gain_ = 1;           // integral of |f| / integral of f, one axis
  std::vector<double> cdf_;  // of |f| over equal steps of [-radius, radius]
};

}  // namespace penumbra
