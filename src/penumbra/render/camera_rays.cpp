#include "penumbra/render/camera_rays.h"

#include <cmath>

namespace penumbra {

CameraRays::CameraRays(const Camera& camera, int width, int height, FilterKind filter, int samples_per_pixel)
    : filter_(filter),
      centred_(samples_per_pixel == 1),
      orthographic_(std::holds_alternative<OrthographicLens>(camera.lens)),
      eye_(camera.to_world[3]),
      forward_(-normalize(Vec3d(camera.to_world[2]))) {
  const Vec3d right = normalize(Vec3d(camera.to_world[0]));
  const Vec3d up = normalize(Vec3d(camera.to_world[1]));
  const double half_height = orthographic_ ? std::get<OrthographicLens>(camera.lens).height / 2
                                           : std::tan(std::get<PerspectiveLens>(camera.lens).vertical_fov / 2);
  const double half_width = half_height * width / height;
  step_x_ = 2 * half_width / width * right;
  step_y_ = -2 * half_height / height * up;
  corner_ = (orthographic_ ? eye_ : forward_) - half_width * right + half_height * up;
}

}  // namespace penumbra
