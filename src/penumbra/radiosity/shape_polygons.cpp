#include "penumbra/radiosity/shape_polygons.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "penumbra/math/frame.h"

namespace penumbra {
namespace {

using Polygons = std::vector<std::vector<Vec3d>>;

/// `segments` points around `centre`, counter-clockwise about `axis`.
std::vector<Vec3d> circle(const Vec3d& centre, const Vec3d& x, const Vec3d& y, double radius, int segments) {
  std::vector<Vec3d> points;
  for (int k = 0; k < segments; ++k) {
    const double angle = 2 * std::numbers::pi * k / segments;
    points.push_back(centre + radius * (std::cos(angle) * x + std::sin(angle) * y));
  }
  return points;
}

/// Appends the band between two circles of equal count, `upper` farther along the axis; its front looks outwards.
void append_band(const std::vector<Vec3d>& lower, const std::vector<Vec3d>& upper, Polygons& out) {
  for (std::size_t k = 0; k < lower.size(); ++k) {
    const std::size_t next = (k + 1) % lower.size();
    out.push_back({lower[k], lower[next], upper[next], upper[k]});
  }
}

/// Appends the triangles from a circle to a pole beyond it.
void append_cap(const std::vector<Vec3d>& ring, const Vec3d& pole, bool upper, Polygons& out) {
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec3d &a = ring[k], &b = ring[(k + 1) % ring.size()];
    out.push_back(upper ? std::vector<Vec3d>{a, b, pole} : std::vector<Vec3d>{b, a, pole});
  }
}

Polygons sphere_polygons(const Sphere& sphere, int segments) {
  Polygons polygons;
  const Vec3d x(1, 0, 0), y(0, 0, -1), pole(0, 1, 0);  // x, y, pole right-handed, +Y up
  const int bands = std::max(2, segments / 2);
  std::vector<Vec3d> below;
  for (int k = 1; k < bands; ++k) {
    const double polar = std::numbers::pi * k / bands;  // from the south pole
    const std::vector<Vec3d> ring =
        circle(sphere.centre - sphere.radius * std::cos(polar) * pole, x, y, sphere.radius * std::sin(polar), segments);
    if (k == 1) {
      append_cap(ring, sphere.centre - sphere.radius * pole, false, polygons);
    } else {
      append_band(below, ring, polygons);
    }
    below = ring;
  }
  append_cap(below, sphere.centre + sphere.radius * pole, true, polygons);
  return polygons;
}

}  // namespace

std::vector<std::vector<Vec3d>> shape_polygons(const Shape& shape, int segments) {
  if (segments < 3) throw std::invalid_argument("A round shape needs 3 segments or more to become polygons.");
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere_polygons(*sphere, segments);
  if (const auto* disk = std::get_if<Disk>(&shape)) {
    const Frame frame(disk->normal);
    return {circle(disk->centre, frame.tangent, frame.bitangent, disk->radius, segments)};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    const Frame frame(normalize(cylinder->top - cylinder->base));
    Polygons polygons;
    append_band(circle(cylinder->base, frame.tangent, frame.bitangent, cylinder->radius, segments),
                circle(cylinder->top, frame.tangent, frame.bitangent, cylinder->radius, segments), polygons);
    return polygons;
  }
  throw std::invalid_argument("A plane has no end and cannot become polygons.");
}

}  // namespace penumbra
