#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "penumbra/math/frame.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/scene.h"

namespace penumbra::testing {

/// Random numbers for test scenes.
class Dice {
 public:
  explicit Dice(std::uint64_t key) : rng_(key) {}

  double unit() { return rng_.next(); }
  double between(double low, double high) { return low + (high - low) * rng_.next(); }
  Vec2d square() {
    const double x = rng_.next();
    return {x, rng_.next()};
  }
  Vec3d cube(double half_side) {
    const double x = between(-half_side, half_side);
    const double y = between(-half_side, half_side);
    return {x, y, between(-half_side, half_side)};
  }
  Vec3d direction() { return sample_sphere(square()); }
  /// 10 to a random power.
  double magnitude(double low_exponent, double high_exponent) {
    return std::pow(10.0, between(low_exponent, high_exponent));
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(rng_.next() * static_cast<double>(n)); }

 private:
  CounterRng rng_;
};

/// The nearest vector that single precision holds. Volatile: the vectoriser of GCC 12 leaves out the rounding of a
/// conversion there and back (-O2, two lanes).
inline Vec3d as_float(const Vec3d& v) {
  volatile float rounded[3] = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  return {rounded[0], rounded[1], rounded[2]};
}

/// A scene of one white matt material and one instance of `mesh`.
inline Scene scene_of(Mesh mesh, const Mat4d& to_world = Mat4d(1.0)) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({"mesh", 0, to_world});
  return scene;
}

/// Unconnected triangles around the origin; coordinates that single precision holds.
inline Mesh random_soup(std::size_t triangles, double half_side, double size, std::uint64_t key) {
  Dice dice(key);
  Mesh mesh;
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3d centre = dice.cube(half_side);
    for (int c = 0; c < 3; ++c) mesh.positions.push_back(as_float(centre + dice.cube(size)));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// A closed sphere of triangles that share vertices: an octahedron whose edges are halved `levels` times. Front
/// outside.
inline Mesh geodesic_sphere(const Vec3d& centre, double radius, int levels) {
  Mesh mesh;
  std::vector<Vec3d> unit = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Mesh::Triangle> triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                           {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
      for (const auto& [k, vertex] : middles) {
        if (k == key) return vertex;
      }
      unit.push_back(normalize(unit[a] + unit[b]));
      middles.emplace_back(key, static_cast<std::uint32_t>(unit.size() - 1));
      return middles.back().second;
    };
    std::vector<Mesh::Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  for (const Vec3d& p : unit) mesh.positions.push_back(as_float(centre + radius * p));
  mesh.triangles = std::move(triangles);
  return mesh;
}

/// A rectangle as two triangles, front towards cross(e1, e2), uv (0,0) at the corner, u along e1 and v along e2.
inline Mesh rectangle(const Vec3d& corner, const Vec3d& e1, const Vec3d& e2) {
  Mesh mesh;
  mesh.positions = {corner, corner + e1, corner + e1 + e2, corner + e2};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return mesh;
}

/// A closed box, front outside, eight shared corners.
inline Mesh box(const Vec3d& lower, const Vec3d& upper) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back(i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Where a ray meets a triangle's plane, in double precision (Moeller & Trumbore 1997).
struct PlaneHit {
  double t = 0;
  double u = 0, v = 0;
  /// Distance from the nearest edge in barycentric units, < 0 outside.
  [[nodiscard]] double margin() const { return std::min({u, v, 1 - u - v}); }
};

inline std::optional<PlaneHit> meet_plane(const Ray& ray, const Vec3d& v0, const Vec3d& v1, const Vec3d& v2) {
  const Vec3d e1 = v1 - v0, e2 = v2 - v0;
  const Vec3d p = cross(ray.direction, e2);
  const double determinant = dot(e1, p);
  if (determinant == 0) return std::nullopt;
  const Vec3d s = ray.origin - v0;
  const Vec3d q = cross(s, e1);
  return PlaneHit{dot(e2, q) / determinant, dot(s, p) / determinant, dot(ray.direction, q) / determinant};
}

/// A random affine placement: rotated, unevenly scaled, mirrored in half of the cases, moved.
inline Mat4d random_placement(Dice& dice, double reach) {
  const Frame turn(dice.direction());
  const Frame skew(dice.direction());
  const Mat3d rotation(turn.tangent, turn.bitangent, turn.normal);
  const Mat3d other(skew.tangent, skew.bitangent, skew.normal);
  Mat3d scale(0.0);
  for (int i = 0; i < 3; ++i) scale[i][i] = dice.between(0.4, 2.0) * (dice.unit() < 0.5 ? -1 : 1);
  const Mat3d m = rotation * scale * other;
  Mat4d placement(m);
  placement[3] = Vec4d(dice.cube(reach), 1);
  return placement;
}

}  // namespace penumbra::testing
