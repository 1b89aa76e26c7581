#include "penumbra/math/spherical_triangle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/math/sampling.h"

namespace penumbra {
namespace {

/// sr: below, triangles are as good as flat, and differences of sines would lose too many digits.
constexpr double flat = 1e-8;

/// The unit part of v at right angles to the unit vector n; zero where there is none.
Vec3d across(const Vec3d& v, const Vec3d& n) {
  const Vec3d rest = v - dot(v, n) * n;
  const double size = length(rest);
  return size > 0 ? rest / size : Vec3d(0);
}

/// From a unit vector towards another at right angles, by the cosine of the angle.
Vec3d turned(const Vec3d& from, const Vec3d& towards, double cosine) {
  return cosine * from + std::sqrt(std::max(0.0, 1 - cosine * cosine)) * towards;
}

}  // namespace

SphericalTriangle::SphericalTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) : a_(a), b_(b), c_(c) {
  // Edges in place of corners, so that a triangle far away keeps its digits.
  const double volume = std::abs(dot(a, cross(b - a, c - a)));
  solid_angle_ = 2 * std::atan2(volume, 1 + dot(a, b) + dot(b, c) + dot(c, a));
  const Vec3d to_b = across(b, a), to_c = across(c, a);
  cos_alpha_ = std::clamp(dot(to_b, to_c), -1.0, 1.0);
  sin_alpha_ = length(cross(to_b, to_c));
}

Vec3d SphericalTriangle::sample(const Vec2d& u) const {
  if (solid_angle_ < flat) {
    const Vec2d w = sample_triangle(u);
    return normalize((1 - w.x - w.y) * a_ + w.x * b_ + w.y * c_);
  }
  // The corner c' between a and c that cuts off the share u.x of the area, then a point on the arc from b to c'.
  const double alpha = std::atan2(sin_alpha_, cos_alpha_), part = u.x * solid_angle_ - alpha;
  const double s = std::sin(part), t = std::cos(part), cos_ab = dot(a_, b_);
  const double p = t - cos_alpha_, q = s + sin_alpha_ * cos_ab;
  const double below = (q * s + p * t) * sin_alpha_;
  const double cos_b = below != 0 ? std::clamp(((q * t - p * s) * cos_alpha_ - q) / below, -1.0, 1.0) : 1.0;
  const Vec3d corner = turned(a_, across(c_, a_), cos_b);
  return normalize(turned(b_, across(corner, b_), 1 - u.y * (1 - dot(corner, b_))));
}

}  // namespace penumbra
