#pragma once

#include <cstdint>

#include "penumbra/scene/mesh.h"
#include "penumbra/tracing/hit.h"

namespace penumbra {

/// A mesh at its place in the world: surface points from triangles and barycentric weights.
class PlacedMesh {
 public:
  /// @param by_instance whether rays are taken into the mesh's own space to be traced, which rounds more; else the mesh
  /// was taken into the world. The mesh must outlive this.
  PlacedMesh(const Mesh& mesh, const Mat4d& to_world, bool by_instance);

  /// The surface at weights `barycentric` of vertices 1 and 2; all but `object` and `primitive` is filled in.
  [[nodiscard]] SurfacePoint point(std::uint32_t triangle, const Vec2d& barycentric) const;

  /// How texture coordinates and the interpolated normal change along a small step over a triangle.
  /// @param position on the triangle, m, world. @param step m, in the triangle's plane.
  [[nodiscard]] SurfaceChange change(std::uint32_t triangle, const Vec3d& position, const Vec3d& step) const;

  /// Takes a normal of the mesh's own space, by the order of corners, to the world's front; not unit.
  [[nodiscard]] Vec3d front_normal(const Vec3d& local) const { return normal_matrix_ * local; }

  /// Whether the placing turns counter-clockwise triangles into clockwise ones; the front stays the front.
  [[nodiscard]] bool mirrors() const { return mirrors_; }

 private:
  // How coordinates round when rays are taken into the mesh's own space: by the sizes that the numbers have on the way
  // there and back, which may be larger than those in the world.
  struct ObjectSpace {
    Mat3d absolute{0.0};    // |M|
    Mat3d there_back{0.0};  // |M| |M^-1|
    Vec3d shift{0};         // |M| |M^-1| |t| + |t|

    ObjectSpace() = default;
    explicit ObjectSpace(const Mat4d& to_world);
    [[nodiscard]] double size(const Vec3d& local, const Vec3d& world) const;
  };

  void add_tangents(const Mesh::Triangle& triangle, const Vec3d& e1, const Vec3d& e2, const Vec2d& b,
                    SurfacePoint& p) const;

  const Mesh* mesh_;
  Mat4d to_world_;
  Mat3d normal_matrix_;
  bool mirrors_;
  ObjectSpace space_;
};

}  // namespace penumbra
