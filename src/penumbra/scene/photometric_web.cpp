#include "penumbra/scene/photometric_web.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra {
namespace {

using std::numbers::pi;

constexpr double degree = pi / 180;

// A place in ascending angles: between which two, and how far.
struct Place {
  std::size_t low = 0, high = 0;
  double part = 0;
};

Place place_in(const std::vector<double>& angles, double angle) {
  const auto above = std::upper_bound(angles.begin(), angles.end(), angle);
  const auto high = static_cast<std::size_t>(above - angles.begin());
  if (high == 0) return {0, 0, 0};
  if (high == angles.size()) return {high - 1, high - 1, 0};
  const double width = angles[high] - angles[high - 1];
  return {high - 1, high, width > 0 ? (angle - angles[high - 1]) / width : 0};
}

// Brings a horizontal angle into those that were measured: one plane stands for all, 0..90 for four mirrored quarters,
// 0..180 for two mirrored halves.
double folded(double angle, double last) {
  angle = std::fmod(angle, 360.0);
  if (angle < 0) angle += 360;
  if (last <= 0) return 0;
  if (last <= 180 && angle > 180) angle = 360 - angle;
  if (last <= 90 && angle > 90) angle = 180 - angle;
  return angle;
}

}  // namespace

double candela_at(const PhotometricWeb& web, double vertical, double horizontal) {
  // A rounding beyond the last angle is still on it.
  if (vertical < web.vertical.front() - 1e-9 || vertical > web.vertical.back() + 1e-9) return 0;
  const Place v = place_in(web.vertical, vertical);
  const Place h = place_in(web.horizontal, folded(horizontal, web.horizontal.back()));
  const auto in_plane = [&](std::size_t plane) {
    const double* row = web.candela.data() + plane * web.vertical.size();
    return (1 - v.part) * row[v.low] + v.part * row[v.high];
  };
  return (1 - h.part) * in_plane(h.low) + h.part * in_plane(h.high);
}

double candela_towards(const PhotometricWeb& web, const WebPlacement& placed, const Vec3d& way) {
  const double down = std::clamp(dot(way, placed.nadir), -1.0, 1.0);
  // Horizontal angles count counter-clockwise as seen from above.
  const double x = dot(way, placed.zero), y = dot(way, cross(placed.zero, placed.nadir));
  const double horizontal = x == 0 && y == 0 ? 0 : std::atan2(y, x) / degree;
  return candela_at(web, std::acos(down) / degree, horizontal);
}

double tilt_factor(const PhotometricWeb& web, const Vec3d& nadir) {
  if (web.tilt.empty()) return 1;
  const Place t = place_in(web.tilt, std::acos(std::clamp(-nadir.y, -1.0, 1.0)) / degree);
  return (1 - t.part) * web.tilt_factors[t.low] + t.part * web.tilt_factors[t.high];
}

double luminous_flux(const PhotometricWeb& web) {
  // Mean over the horizontal angle: trapezoids are exact for what is linear between angles.
  std::vector<double> mean(web.vertical.size(), 0.0);
  const double span = web.horizontal.back() - web.horizontal.front();
  for (std::size_t v = 0; v < mean.size(); ++v) {
    if (!(span > 0)) {
      mean[v] = web.candela[v];
      continue;
    }
    for (std::size_t h = 0; h + 1 < web.horizontal.size(); ++h) {
      const double width = web.horizontal[h + 1] - web.horizontal[h];
      mean[v] += 0.5 * width / span * (web.candela[h * mean.size() + v] + web.candela[(h + 1) * mean.size() + v]);
    }
  }
  // Of I = p + q theta, the integral of 2 pi I sin(theta) is 2 pi [-(p + q theta) cos(theta) + q sin(theta)].
  double flux = 0;
  for (std::size_t v = 0; v + 1 < mean.size(); ++v) {
    const double a = web.vertical[v] * degree, b = web.vertical[v + 1] * degree;
    if (!(b > a)) continue;
    const double q = (mean[v + 1] - mean[v]) / (b - a);
    flux += 2 * pi * (mean[v] * std::cos(a) - mean[v + 1] * std::cos(b) + q * (std::sin(b) - std::sin(a)));
  }
  return flux;
}

}  // namespace penumbra
