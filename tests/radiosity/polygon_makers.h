#pragma once

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <random>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/math/transform.h"
#include "penumbra/math/vec.h"

namespace penumbra {

using Polygon = std::vector<Vec3d>;

inline Polygon reversed(Polygon p) { return {p.rbegin(), p.rend()}; }

inline Polygon moved(Polygon p, const Vec3d& by) {
  for (Vec3d& v : p) v += by;
  return p;
}

inline Polygon transformed(Polygon p, const Mat4d& m) {
  for (Vec3d& v : p) v = transform_point(m, v);
  return p;
}

/// A rectangle in the plane z = height, its front up.
inline Polygon floor_rectangle(double x0, double x1, double y0, double y1, double height = 0) {
  return {{x0, y0, height}, {x1, y0, height}, {x1, y1, height}, {x0, y1, height}};
}

/// A regular polygon inscribed in a circle about the z axis, its front up.
inline Polygon floor_disk(double radius, double height, int corners, const Vec2d& centre = Vec2d(0)) {
  Polygon p;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    p.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle), height});
  }
  return p;
}

/// The sides of a prism about the z axis between two regular polygons, fronts outwards; radii may differ or be 0.
inline std::vector<Polygon> outward_band(double radius0, double height0, double radius1, double height1, int corners) {
  const Polygon lower = floor_disk(radius0, height0, corners), upper = floor_disk(radius1, height1, corners);
  std::vector<Polygon> sides;
  for (std::size_t k = 0; k < lower.size(); ++k) {
    const std::size_t next = (k + 1) % lower.size();
    Polygon side{lower[k], lower[next], upper[next], upper[k]};
    if (radius1 == 0) side.pop_back();
    if (radius0 == 0) side.erase(side.begin());
    sides.push_back(side);
  }
  return sides;
}

inline std::vector<Polygon> reversed(const std::vector<Polygon>& all) {
  std::vector<Polygon> out;
  for (const Polygon& p : all) out.push_back(reversed(p));
  return out;
}

/// The six faces of [0, size.x] x [0, size.y] x [0, size.z], fronts inwards: floor, ceiling, x = 0, x = 1, y = 0, y
/// = 1.
inline std::vector<Polygon> room(const Vec3d& size) {
  const double x = size.x, y = size.y, z = size.z;
  return {{{0, 0, 0}, {x, 0, 0}, {x, y, 0}, {0, y, 0}}, {{0, 0, z}, {0, y, z}, {x, y, z}, {x, 0, z}},
          {{0, 0, 0}, {0, y, 0}, {0, y, z}, {0, 0, z}}, {{x, 0, 0}, {x, 0, z}, {x, y, z}, {x, y, 0}},
          {{0, 0, 0}, {0, 0, z}, {x, 0, z}, {x, 0, 0}}, {{0, y, 0}, {x, y, 0}, {x, y, z}, {0, y, z}}};
}

/// Random numbers for property tests; each test starts its own with a fixed seed.
class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  Vec3d in_cube(double half = 1) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  Vec3d direction() {
    for (;;) {
      const Vec3d v = in_cube();
      const double l = length(v);
      if (l > 0.1 && l < 1) return v / l;
    }
  }
  /// A rotation, then a translation.
  Mat4d motion() {
    const Vec3d x = direction(), y = normalize(cross(x, direction())), z = cross(x, y);
    return Mat4d(Vec4d(x, 0), Vec4d(y, 0), Vec4d(z, 0), Vec4d(in_cube(3), 1));
  }
  /// A convex polygon of 3 to 7 corners on an ellipse somewhere in the cube.
  Polygon convex_polygon() {
    const int corners = 3 + static_cast<int>(between(0, 5));
    std::vector<double> angles;
    for (int k = 0; k < corners; ++k) angles.push_back(2 * std::numbers::pi * (k + between(0.1, 0.9)) / corners);
    const double a = between(0.1, 1), b = between(0.1, 1);
    Polygon p;
    for (const double angle : angles) p.push_back({a * std::cos(angle), b * std::sin(angle), 0});
    return transformed(p, motion());
  }
  /// The faces of a random bounded polyhedron, fronts inwards: a cube cut by `cuts` random planes.
  std::vector<Polygon> convex_cavity(int cuts) {
    std::vector<Plane3> half_spaces;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        Vec3d n(0);
        n[axis] = sign;
        half_spaces.push_back({n, -1});
      }
    }
    for (int k = 0; k < cuts; ++k) half_spaces.push_back({direction(), -between(0.4, 1.2)});
    std::vector<Polygon> faces;
    for (std::size_t i = 0; i < half_spaces.size(); ++i) {
      const Vec3d n = half_spaces[i].normal;
      const Vec3d x = normalize(cross(n, std::abs(n.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0))), y = cross(n, x);
      const Vec3d c = half_spaces[i].offset * n;
      Polygon face{c - 9.0 * x - 9.0 * y, c + 9.0 * x - 9.0 * y, c + 9.0 * x + 9.0 * y, c - 9.0 * x + 9.0 * y}, cut;
      for (std::size_t k = 0; k < half_spaces.size(); ++k) {
        if (k == i) continue;
        clip_polygon(face, half_spaces[k], 1e-12, cut);
        face.swap(cut);
      }
      if (polygon_area(face) > 1e-9) faces.push_back(face);
    }
    return faces;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace penumbra
