#pragma once

#include <optional>

#include "penumbra/render/aperture_sampler.h"
#include "penumbra/render/filter.h"
#include "penumbra/render/pixel_sampler.h"
#include "penumbra/scene/camera.h"
#include "penumbra/tracing/ray_differential.h"

namespace penumbra {

/// Camera rays by pixel: the camera's frame worked out once, the reconstruction filter that places the sub-pixels, the
/// lens that they pass, and the time at which they are sent.
///
/// One sample a pixel goes through the pixel's centre, in the middle of the exposure; more are jittered. Each passes a
/// random point of the lens.
class CameraRays {
 public:
  /// @param timed rays are spread over the time that the shutter is open; they are in any case when the camera moves.
  CameraRays(const Camera& camera, int width, int height, FilterKind filter, int samples_per_pixel, bool timed = false);

  struct Sub {
    Ray ray;
    float weight;  ///< 0: no light comes this way, there is nothing to trace
  };
  [[nodiscard]] Sub ray(int x, int y, PixelSampler& sampler) const {
    const Filter::Position at = sub_pixel(sampler);
    const double time = this->time(sampler);
    const Vec2d raster(x + 0.5 + at.offset.x, y + 0.5 + at.offset.y);
    if (aperture_) return through_lens(raster, time, at.weight, sampler);
    const Ray ray = through(raster.x, raster.y, time);
    return {ray, ray.direction == Vec3d(0) ? 0 : at.weight};
  }

  /// Where a sample lies in its pixel.
  [[nodiscard]] Filter::Position sub_pixel(PixelSampler& sampler) const {
    return centred_ ? Filter::Position{{0, 0}, 1.0F} : filter_.sample(sampler.next_2d());
  }
  /// When a sample is taken, 0 (the shutter opens) to 1; drawn after `sub_pixel`.
  [[nodiscard]] double time(PixelSampler& sampler) const { return !timed_ ? 0 : centred_ ? 0.5 : sampler.next_1d(); }

  /// How many random numbers `sub_pixel` and `time` draw.
  [[nodiscard]] int drawn() const { return centred_ ? 0 : timed_ ? 2 : 1; }

  /// The ray through raster coordinates in pixels, from the top left corner, and the middle of the lens; its direction
  /// is 0 where the camera sees nothing.
  [[nodiscard]] Ray through(double x, double y, double time = 0) const;

  /// How a ray of this camera differs from that of the next sample, as the samples of a pixel stand on average: a
  /// pixel's distance over the root of their number.
  [[nodiscard]] RayDifferential differential(const Ray& ray) const;

  [[nodiscard]] bool centred() const { return centred_; }
  /// Whether rays are sent at different times.
  [[nodiscard]] bool is_timed() const { return timed_; }
  [[nodiscard]] const Filter& filter() const { return filter_; }
  /// Of the samples, pixels: as `differential` takes it.
  [[nodiscard]] double spacing() const { return spacing_; }
  /// Whether all rays leave the eye through points of a plane, evenly spaced.
  [[nodiscard]] bool is_pinhole() const { return plane_ && !orthographic_ && !aperture_ && camera_.motion.empty(); }
  [[nodiscard]] const Vec3d& eye() const { return rest_.eye; }
  /// Perspective: the direction (not unit) through the picture's top left corner. Orthographic: that corner itself.
  [[nodiscard]] const Vec3d& corner() const { return rest_.corner; }
  [[nodiscard]] const Vec3d& step_x() const { return rest_.step_x; }
  [[nodiscard]] const Vec3d& step_y() const { return rest_.step_y; }

 private:
  /// Where the camera stands at a time, and the raster that it sees.
  struct Pose {
    Vec3d eye{0}, forward{0}, right{0}, up{0};
    Vec3d corner{0}, step_x{0}, step_y{0};
  };
  [[nodiscard]] Pose pose_of(const Mat4d& to_world) const;
  [[nodiscard]] Pose pose_at(double time) const {
    return camera_.motion.empty() ? rest_ : pose_of(placement_at(camera_.motion, time));
  }
  [[nodiscard]] Sub through_lens(const Vec2d& raster, double time, float weight, PixelSampler& sampler) const;
  [[nodiscard]] RayDifferential turning(const Ray& ray) const;

  Camera camera_;
  double width_, height_;  // pixels
  Filter filter_;
  std::optional<ApertureSampler> aperture_;
  bool centred_;
  bool timed_;
  double spacing_;  // of the samples, pixels
  bool orthographic_;
  bool plane_;  // perspective or orthographic
  Pose rest_;
};

}  // namespace penumbra
