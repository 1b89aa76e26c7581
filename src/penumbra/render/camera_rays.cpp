#include "penumbra/render/camera_rays.h"

#include <cmath>
#include <stdexcept>

namespace penumbra {

CameraRays::CameraRays(const Camera& camera, int width, int height, FilterKind filter, int samples_per_pixel)
    : camera_(camera),
      width_(width),
      height_(height),
      filter_(filter),
      centred_(samples_per_pixel == 1),
      orthographic_(std::holds_alternative<OrthographicLens>(camera.lens)),
      plane_(orthographic_ || std::holds_alternative<PerspectiveLens>(camera.lens)),
      eye_(camera.to_world[3]),
      forward_(-normalize(Vec3d(camera.to_world[2]))),
      right_(normalize(Vec3d(camera.to_world[0]))),
      up_(normalize(Vec3d(camera.to_world[1]))) {
  if (camera.thin_lens) {
    if (!std::holds_alternative<PerspectiveLens>(camera.lens)) {
      throw std::invalid_argument("only a perspective camera has a thin lens");
    }
    if (camera.thin_lens->radius > 0) aperture_.emplace(*camera.thin_lens);
  }
  if (!plane_) return;
  const double half_height = orthographic_ ? std::get<OrthographicLens>(camera.lens).height / 2
                                           : std::tan(std::get<PerspectiveLens>(camera.lens).vertical_fov / 2);
  const double half_width = half_height * width / height;
  step_x_ = 2 * half_width / width * right_;
  step_y_ = -2 * half_height / height * up_;
  corner_ = (orthographic_ ? eye_ : forward_) - half_width * right_ + half_height * up_;
}

// All rays of a picture point meet where the ray through the lens's middle crosses the plane in focus.
CameraRays::Sub CameraRays::through_lens(const Vec2d& raster, float weight, PixelSampler& sampler) const {
  const ThinLens& lens = *camera_.thin_lens;
  const Vec2d half = Vec2d(width_, height_) / 2.0;
  const Vec2d from_middle = Vec2d(raster.x - half.x, half.y - raster.y) / length(half);
  const auto point = aperture_->sample(sampler.next_2d(), from_middle);
  if (!point) return {{.origin = eye_, .direction = forward_}, 0};
  const Vec3d in_focus = lens.focus * (corner_ + raster.x * step_x_ + raster.y * step_y_);
  const Vec3d on_lens = lens.radius * (point->x * right_ + point->y * up_);
  return {{.origin = eye_ + on_lens, .direction = normalize(in_focus - on_lens)}, weight};
}

}  // namespace penumbra
