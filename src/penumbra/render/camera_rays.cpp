#include "penumbra/render/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace penumbra {

CameraRays::CameraRays(const Camera& camera, int width, int height, FilterKind filter, int samples_per_pixel,
                       bool timed)
    : camera_(camera),
      width_(width),
      height_(height),
      filter_(filter),
      centred_(samples_per_pixel == 1),
      timed_(timed || !camera.motion.empty()),
      spacing_(1 / std::sqrt(static_cast<double>(samples_per_pixel))),
      orthographic_(std::holds_alternative<OrthographicLens>(camera.lens)),
      plane_(orthographic_ || std::holds_alternative<PerspectiveLens>(camera.lens)),
      rest_(pose_of(camera.to_world)) {
  if (camera.thin_lens) {
    if (!std::holds_alternative<PerspectiveLens>(camera.lens)) {
      throw std::invalid_argument("only a perspective camera has a thin lens");
    }
    if (camera.thin_lens->radius > 0) aperture_.emplace(*camera.thin_lens);
  }
}

CameraRays::Pose CameraRays::pose_of(const Mat4d& to_world) const {
  Pose pose{.eye = Vec3d(to_world[3]),
            .forward = -normalize(Vec3d(to_world[2])),
            .right = normalize(Vec3d(to_world[0])),
            .up = normalize(Vec3d(to_world[1]))};
  if (!plane_) return pose;
  const double half_height = orthographic_ ? std::get<OrthographicLens>(camera_.lens).height / 2
                                           : std::tan(std::get<PerspectiveLens>(camera_.lens).vertical_fov / 2);
  const double half_width = half_height * width_ / height_;
  pose.step_x = 2 * half_width / width_ * pose.right;
  pose.step_y = -2 * half_height / height_ * pose.up;
  pose.corner = (orthographic_ ? pose.eye : pose.forward) - half_width * pose.right + half_height * pose.up;
  return pose;
}

Ray CameraRays::through(double x, double y, double time) const {
  if (!plane_) {
    Camera camera = camera_;
    if (!camera.motion.empty()) camera.to_world = placement_at(camera.motion, time);
    Ray ray = camera.ray(x / width_, y / height_, width_ / height_);
    ray.time = time;
    return ray;
  }
  const auto in = [&](const Pose& pose) -> Ray {
    const Vec3d shift = x * pose.step_x + y * pose.step_y;
    if (orthographic_) return {.origin = pose.corner + shift, .direction = pose.forward, .time = time};
    return {.origin = pose.eye, .direction = normalize(pose.corner + shift), .time = time};
  };
  return camera_.motion.empty() ? in(rest_) : in(pose_at(time));
}

// All rays of a picture point meet where the ray through the lens's middle crosses the plane in focus.
CameraRays::Sub CameraRays::through_lens(const Vec2d& raster, double time, float weight, PixelSampler& sampler) const {
  const ThinLens& lens = *camera_.thin_lens;
  const Vec2d half = Vec2d(width_, height_) / 2.0;
  const Vec2d from_middle = Vec2d(raster.x - half.x, half.y - raster.y) / length(half);
  const auto point = aperture_->sample(sampler.next_2d(), from_middle);
  const Pose pose = pose_at(time);
  if (!point) return {{.origin = pose.eye, .direction = pose.forward, .time = time}, 0};
  const Vec3d in_focus = lens.focus * (pose.corner + raster.x * pose.step_x + raster.y * pose.step_y);
  const Vec3d on_lens = lens.radius * (point->x * pose.right + point->y * pose.up);
  return {{.origin = pose.eye + on_lens, .direction = normalize(in_focus - on_lens), .time = time}, weight};
}

// A perspective direction is v / |v| for a v that moves by the raster's step while v.forward stays 1; so does a thin
// lens's, seen from its own point of the lens (Igehy 1999, equations 8 and 9).
RayDifferential CameraRays::differential(const Ray& ray) const {
  if (!plane_) return turning(ray);
  const Pose pose = pose_at(ray.time);
  if (orthographic_) return {.origin_x = spacing_ * pose.step_x, .origin_y = spacing_ * pose.step_y};
  const double shrink = spacing_ * dot(ray.direction, pose.forward);
  const auto turned = [&](const Vec3d& step) { return shrink * (step - dot(ray.direction, step) * ray.direction); };
  return {.direction_x = turned(pose.step_x), .direction_y = turned(pose.step_y)};
}

// Panoramas and fisheyes, whose pixels stand for angles.
RayDifferential CameraRays::turning(const Ray& ray) const {
  const Pose pose = pose_at(ray.time);
  const Vec3d& d = ray.direction;
  const auto* fisheye = std::get_if<FisheyeLens>(&camera_.lens);
  const Vec3d& axis = fisheye != nullptr ? pose.forward : pose.up;
  const Vec3d around = cross(d, axis);
  const double sine = length(around);  // of the angle from the axis
  if (!(sine > 1e-6)) {
    const double angle = (fisheye != nullptr ? fisheye->fov : std::numbers::pi) / std::min(width_, height_);
    return {.direction_x = spacing_ * angle * pose.right, .direction_y = spacing_ * angle * pose.forward};
  }
  const Vec3d east = around / sine;
  const Vec3d north = cross(east, d);
  if (fisheye == nullptr) {
    return {.direction_x = spacing_ * (2 * std::numbers::pi / width_) * sine * east,
            .direction_y = spacing_ * (std::numbers::pi / height_) * north};
  }
  const double angle = fisheye->fov / std::min(width_, height_);
  const double from_axis = std::atan2(sine, dot(d, axis));
  return {.direction_x = spacing_ * angle * sine / from_axis * east, .direction_y = spacing_ * angle * north};
}

}  // namespace penumbra
