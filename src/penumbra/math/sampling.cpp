#include "penumbra/math/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra {

using std::numbers::pi;

Vec2d sample_disk(const Vec2d& u) {
  const Vec2d p = 2.0 * u - Vec2d(1.0);
  if (p.x == 0 && p.y == 0) return {0, 0};
  const bool wide = std::abs(p.x) > std::abs(p.y);
  const double r = wide ? p.x : p.y;
  const double phi = wide ? pi / 4 * (p.y / p.x) : pi / 2 - pi / 4 * (p.x / p.y);
  return {r * std::cos(phi), r * std::sin(phi)};
}

Vec3d sample_cosine_hemisphere(const Vec2d& u) {
  const Vec2d d = sample_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0, 1.0 - d.x * d.x - d.y * d.y))};
}

Vec3d sample_sphere(const Vec2d& u) {
  const double z = 1.0 - 2.0 * u.x;
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), z};
}

Vec3d sample_cone(const Vec2d& u, double cos_max) {
  const double z = 1.0 - u.x * (1.0 - cos_max);
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), z};
}

Vec2d sample_triangle(const Vec2d& u) {
  const double root = std::sqrt(u.x);
  return {root * (1.0 - u.y), root * u.y};
}

}  // namespace penumbra
