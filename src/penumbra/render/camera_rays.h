#pragma once

#include "penumbra/render/filter.h"
#include "penumbra/render/pixel_sampler.h"
#include "penumbra/scene/camera.h"

namespace penumbra {

/// Camera rays by pixel: the camera's frame worked out once, and the reconstruction filter that places the sub-pixels.
///
/// One sample a pixel goes through the pixel's centre; more are jittered.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height, FilterKind filter, int samples_per_pixel);

  struct Sub {
    Ray ray;
    float weight;
  };
  [[nodiscard]] Sub ray(int x, int y, PixelSampler& sampler) const {
    const Filter::Position at = sub_pixel(sampler);
    return {through(x + 0.5 + at.offset.x, y + 0.5 + at.offset.y), at.weight};
  }

  /// Where a sample lies in its pixel.
  [[nodiscard]] Filter::Position sub_pixel(PixelSampler& sampler) const {
    return centred_ ? Filter::Position{{0, 0}, 1.0F} : filter_.sample(sampler.next_2d());
  }

  /// The ray through raster coordinates in pixels, from the top left corner.
  [[nodiscard]] Ray through(double x, double y) const {
    const Vec3d shift = x * step_x_ + y * step_y_;
    if (orthographic_) return {.origin = corner_ + shift, .direction = forward_};
    return {.origin = eye_, .direction = normalize(corner_ + shift)};
  }

  [[nodiscard]] bool centred() const { return centred_; }
  [[nodiscard]] bool orthographic() const { return orthographic_; }
  [[nodiscard]] const Vec3d& eye() const { return eye_; }
  /// Perspective: the direction (not unit) through the picture's top left corner. Orthographic: that corner itself.
  [[nodiscard]] const Vec3d& corner() const { return corner_; }
  [[nodiscard]] const Vec3d& step_x() const { return step_x_; }
  [[nodiscard]] const Vec3d& step_y() const { return step_y_; }
  [[nodiscard]] const Vec3d& forward() const { return forward_; }

 private:
  Filter filter_;
  bool centred_;
  bool orthographic_;
  Vec3d eye_, forward_, corner_, step_x_, step_y_;
};

}  // namespace penumbra
