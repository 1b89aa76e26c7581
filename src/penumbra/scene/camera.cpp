#include "penumbra/scene/camera.h"

#include <cmath>

namespace penumbra {

Ray Camera::ray(double x, double y, double aspect) const {
  const Vec3d right = normalize(Vec3d(to_world[0]));
  const Vec3d up = normalize(Vec3d(to_world[1]));
  const Vec3d forward = -normalize(Vec3d(to_world[2]));
  const Vec3d eye(to_world[3]);
  const double sx = 2 * x - 1;
  const double sy = 1 - 2 * y;
  if (const auto* flat = std::get_if<OrthographicLens>(&lens)) {
    const double half = flat->height / 2;
    return {.origin = eye + sx * half * aspect * right + sy * half * up, .direction = forward};
  }
  const double half = std::tan(std::get<PerspectiveLens>(lens).vertical_fov / 2);
  return {.origin = eye, .direction = normalize(forward + sx * half * aspect * right + sy * half * up)};
}

}  // namespace penumbra
