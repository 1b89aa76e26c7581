#include "penumbra/tracing/shading/checker.h"

#include <algorithm>
#include <cmath>

#include "penumbra/tracing/shading/footprint_axes.h"

namespace penumbra {
namespace {

constexpr double most_boxes = 64;
// Boxes no narrower than this (in squares) resolve how a slanting footprint runs along the squares' diagonals.
constexpr double narrowest_box = 0.25;

/// The two axes in which the squares lie: those that the surface is least inclined to.
struct Plane2d {
  int first = 0;
  int second = 0;
  [[nodiscard]] Vec2d of(const Vec3d& v) const { return {v[first], v[second]}; }
};

Plane2d plane_of(const Vec3d& normal) {
  const Vec3d n = glm::abs(normal);
  const int across = n.x > n.y && n.x > n.z ? 0 : (n.y >= n.z ? 1 : 2);
  return {(across + 1) % 3, (across + 2) % 3};
}

// Integral from 0 to x of the wave that is +1 where floor(x) is even and -1 where it is odd.
double wave_integral(double x) {
  const double phase = x - 2 * std::floor(x / 2);
  return phase < 1 ? phase : 2 - phase;
}

// The mean of that wave over a box.
double mean_wave(double middle, double width) {
  if (!(width > 1e-9)) return std::fmod(std::abs(std::floor(middle)), 2.0) == 1.0 ? -1.0 : 1.0;
  return (wave_integral(middle + width / 2) - wave_integral(middle - width / 2)) / width;
}

}  // namespace

float second_colour_share(const SurfacePoint& point, double size) {
  const Vec2d at = plane_of(point.geometric_normal).of(point.position) / size;
  return std::fmod(std::abs(std::floor(at.x) + std::floor(at.y)), 2.0) == 1.0 ? 1.0F : 0.0F;
}

// The squares are the product of one wave along each axis: first colour where it is 1, second where it is -1.
float second_colour_share(const SurfacePoint& point, double size, const Footprint& footprint) {
  const Plane2d plane = plane_of(point.geometric_normal);
  const Vec2d at = plane.of(point.position) / size;
  const FootprintAxes axes = axes_of(plane.of(footprint.x) / size, plane.of(footprint.y) / size);
  if (!std::isfinite(axes.major_length)) return 0.5F;
  const double boxes =
      std::clamp(std::ceil(axes.major_length / std::max(axes.minor_length, narrowest_box)), 1.0, most_boxes);
  const Vec2d step = axes.major / boxes;
  const Vec2d width = glm::sqrt(step * step + axes.minor * axes.minor);
  double mean = 0;
  for (double k = 0.5 * (1 - boxes); k < 0.5 * boxes; ++k) {
    const Vec2d middle = at + k * step;
    mean += mean_wave(middle.x, width.x) * mean_wave(middle.y, width.y) / boxes;
  }
  return static_cast<float>(0.5 - 0.5 * mean);
}

}  // namespace penumbra
