#include "penumbra/scene/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra {

namespace {

struct Axes {
  Vec3d right, up, forward;
};

Vec3d panoramic(double sx, double sy, const Axes& axes) {
  const double longitude = sx * std::numbers::pi, latitude = sy * std::numbers::pi / 2;
  return std::cos(latitude) * (std::cos(longitude) * axes.forward + std::sin(longitude) * axes.right) +
         std::sin(latitude) * axes.up;
}

Vec3d fisheye(double sx, double sy, double aspect, double fov, const Axes& axes) {
  const Vec2d from_middle = Vec2d(sx * aspect, sy) / std::min(1.0, aspect);
  const double r = length(from_middle);
  if (r > 1) return Vec3d(0);
  const double angle = r * fov / 2;
  const double across = r > 0 ? std::sin(angle) / r : 0;
  return std::cos(angle) * axes.forward + across * (from_middle.x * axes.right + from_middle.y * axes.up);
}

}  // namespace

Ray Camera::ray(double x, double y, double aspect) const {
  const Axes axes{normalize(Vec3d(to_world[0])), normalize(Vec3d(to_world[1])), -normalize(Vec3d(to_world[2]))};
  const Vec3d eye(to_world[3]);
  const double sx = 2 * x - 1;
  const double sy = 1 - 2 * y;
  if (const auto* flat = std::get_if<OrthographicLens>(&lens)) {
    const double half = flat->height / 2;
    return {.origin = eye + sx * half * aspect * axes.right + sy * half * axes.up, .direction = axes.forward};
  }
  if (std::holds_alternative<PanoramicLens>(lens)) return {.origin = eye, .direction = panoramic(sx, sy, axes)};
  if (const auto* round = std::get_if<FisheyeLens>(&lens)) {
    return {.origin = eye, .direction = fisheye(sx, sy, aspect, round->fov, axes)};
  }
  const double half = std::tan(std::get<PerspectiveLens>(lens).vertical_fov / 2);
  return {.origin = eye, .direction = normalize(axes.forward + sx * half * aspect * axes.right + sy * half * axes.up)};
}

}  // namespace penumbra
