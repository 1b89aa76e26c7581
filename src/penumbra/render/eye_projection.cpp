#include "penumbra/render/eye_projection.h"

#include <cmath>
#include <stdexcept>

namespace penumbra {

EyeProjection::EyeProjection(const Camera& camera, int width, int height)
    : eye_(camera.to_world[3]),
      forward_(-normalize(Vec3d(camera.to_world[2]))),
      right_(normalize(Vec3d(camera.to_world[0]))),
      up_(normalize(Vec3d(camera.to_world[1]))),
      width_(width),
      height_(height) {
  const auto* lens = std::get_if<PerspectiveLens>(&camera.lens);
  if (lens == nullptr || (camera.thin_lens && camera.thin_lens->radius > 0)) {
    throw std::invalid_argument(
        "tracing from the lights needs a perspective camera without a lens; leave --projection and --f-number away, or "
        "trace from the eye");
  }
  scale_ = height / (2 * std::tan(lens->vertical_fov / 2));
}

std::optional<EyeProjection::Place> EyeProjection::place(const Vec3d& direction) const {
  const double along = dot(direction, forward_);
  if (!(along > 0)) return std::nullopt;
  const double x = std::floor(width_ / 2.0 + scale_ * dot(direction, right_) / along);
  const double y = std::floor(height_ / 2.0 - scale_ * dot(direction, up_) / along);
  if (!(x >= 0 && x < width_ && y >= 0 && y < height_)) return std::nullopt;
  return Place{static_cast<int>(x), static_cast<int>(y), scale_ * scale_ / (along * along * along)};
}

}  // namespace penumbra
