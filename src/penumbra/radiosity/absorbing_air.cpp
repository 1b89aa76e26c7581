#include "penumbra/radiosity/absorbing_air.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace penumbra {
namespace {

/// Where a polygon is looked at: three points a triangle of its fan, each with its share of the area (Strang & Fix
/// 1973, degree 2).
struct GaussPoints {
  std::vector<Vec3d> places;
  std::vector<double> areas;
  Vec3d normal{0};  ///< not unit
};

GaussPoints gauss_points(std::span<const Vec3d> polygon) {
  GaussPoints points;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3d &a = polygon[0], &b = polygon[k - 1], &c = polygon[k];
    const Vec3d normal = cross(b - a, c - a);
    points.normal += normal;
    for (const Vec3d& at : {(4.0 * a + b + c) / 6.0, (a + 4.0 * b + c) / 6.0, (a + b + 4.0 * c) / 6.0}) {
      points.places.push_back(at);
      points.areas.push_back(length(normal) / 6);
    }
  }
  return points;
}

}  // namespace

AbsorbingAir::AbsorbingAir(const Scene& scene) : media_(scene) {
  if (media_.none()) return;
  if (media_.scatter()) {
    throw std::invalid_argument(
        "radiosity knows air that absorbs, but none that scatters; set the albedo of fog to 0, or render with path");
  }
  const bool filled = std::any_of(scene.materials.begin(), scene.materials.end(),
                                  [](const Material& m) { return m.medium.has_value(); });
  if (filled) throw std::invalid_argument("radiosity knows no media in closed meshes; render with path");
  for (const std::uint32_t m : scene.air) {
    const Rgb sigma = scene.media[m].extinction();
    if (sigma.x != sigma.y || sigma.y != sigma.z) {
      throw std::invalid_argument("radiosity knows air that absorbs all colours alike, but no coloured one");
    }
  }
}

double AbsorbingAir::transmittance(const Vec3d& from, const Vec3d& to) const {
  const double distance = length(to - from);
  if (!(distance > 0)) return 1;
  const Ray ray{.origin = from, .direction = (to - from) / distance, .t_min = 0, .t_max = distance};
  return std::exp(-media_.optical_depth(std::nullopt, ray).y);
}

double AbsorbingAir::between(std::span<const Vec3d> a, std::span<const Vec3d> b) const {
  const GaussPoints from = gauss_points(a), to = gauss_points(b);
  double left = 0, all = 0;
  for (std::size_t i = 0; i < from.places.size(); ++i) {
    for (std::size_t k = 0; k < to.places.size(); ++k) {
      const Vec3d way = to.places[k] - from.places[i];
      const double r2 = length_squared(way);
      const double cosines = dot(from.normal, way) * -dot(to.normal, way);
      if (!(cosines > 0)) continue;
      const double kernel = from.areas[i] * to.areas[k] * cosines / (r2 * r2);
      all += kernel;
      left += kernel * transmittance(from.places[i], to.places[k]);
    }
  }
  return all > 0 ? left / all : transmittance(from.places[0], to.places[0]);
}

}  // namespace penumbra
