#pragma once

#include <optional>

#include "penumbra/math/vec.h"
#include "penumbra/scene/camera.h"

namespace penumbra {

/// Where in a picture a pinhole eye sees what comes from a direction, and how much it counts there.
class EyeProjection {
 public:
  /// @param width, height of the picture, pixels. Throws std::invalid_argument for other cameras than perspective ones
  /// without a lens.
  EyeProjection(const Camera& camera, int width, int height);

  struct Place {
    int x = 0, y = 0;       ///< pixel
    double importance = 0;  ///< 1/sr: a pixel's radiance is the mean over its square, which this turns into an integral
                            ///< over solid angle: 1 / (area of a pixel at distance 1 x cos^3 to the view)
  };
  /// @param direction unit, from the eye. None outside the picture.
  [[nodiscard]] std::optional<Place> place(const Vec3d& direction) const;

  [[nodiscard]] const Vec3d& eye() const { return eye_; }
  [[nodiscard]] const Vec3d& forward() const { return forward_; }

 private:
  Vec3d eye_, forward_, right_, up_;
  int width_, height_;
  double scale_;  // pixels at distance 1
};

}  // namespace penumbra
