#pragma once

#include <optional>

#include "penumbra/render/aperture_sampler.h"
#include "penumbra/render/filter.h"
#include "penumbra/render/pixel_sampler.h"
#include "penumbra/scene/camera.h"

namespace penumbra {

/// Camera rays by pixel: the camera's frame worked out once, the reconstruction filter that places the sub-pixels, and
/// the lens that they pass.
///
/// One sample a pixel goes through the pixel's centre; more are jittered. Each passes a random point of the lens.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height, FilterKind filter, int samples_per_pixel);

  struct Sub {
    Ray ray;
    float weight;  ///< 0: no light comes this way, there is nothing to trace
  };
  [[nodiscard]] Sub ray(int x, int y, PixelSampler& sampler) const {
    const Filter::Position at = sub_pixel(sampler);
    const Vec2d raster(x + 0.5 + at.offset.x, y + 0.5 + at.offset.y);
    if (aperture_) return through_lens(raster, at.weight, sampler);
    const Ray ray = through(raster.x, raster.y);
    return {ray, ray.direction == Vec3d(0) ? 0 : at.weight};
  }

  /// Where a sample lies in its pixel.
  [[nodiscard]] Filter::Position sub_pixel(PixelSampler& sampler) const {
    return centred_ ? Filter::Position{{0, 0}, 1.0F} : filter_.sample(sampler.next_2d());
  }

  /// The ray through raster coordinates in pixels, from the top left corner, and the middle of the lens; its direction
  /// is 0 where the camera sees nothing.
  [[nodiscard]] Ray through(double x, double y) const {
    if (!plane_) return camera_.ray(x / width_, y / height_, width_ / height_);
    const Vec3d shift = x * step_x_ + y * step_y_;
    if (orthographic_) return {.origin = corner_ + shift, .direction = forward_};
    return {.origin = eye_, .direction = normalize(corner_ + shift)};
  }

  [[nodiscard]] bool centred() const { return centred_; }
  /// Whether all rays leave the eye through points of a plane, evenly spaced.
  [[nodiscard]] bool is_pinhole() const { return plane_ && !orthographic_ && !aperture_; }
  [[nodiscard]] const Vec3d& eye() const { return eye_; }
  /// Perspective: the direction (not unit) through the picture's top left corner. Orthographic: that corner itself.
  [[nodiscard]] const Vec3d& corner() const { return corner_; }
  [[nodiscard]] const Vec3d& step_x() const { return step_x_; }
  [[nodiscard]] const Vec3d& step_y() const { return step_y_; }

 private:
  [[nodiscard]] Sub through_lens(const Vec2d& raster, float weight, PixelSampler& sampler) const;

  Camera camera_;
  double width_, height_;  // pixels
  Filter filter_;
  std::optional<ApertureSampler> aperture_;
  bool centred_;
  bool orthographic_;
  bool plane_;  // perspective or orthographic
  Vec3d eye_, forward_, right_, up_, corner_{0}, step_x_{0}, step_y_{0};
};

}  // namespace penumbra
