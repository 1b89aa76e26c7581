#pragma once

#include "penumbra/scene/mesh.h"
#include "penumbra/scene/scene.h"
#include "penumbra/scene/shape.h"

namespace penumbra {

// Exact primitives as triangles, for what knows nothing else: a mesh of unit size with smooth normals, and where
// it stands. The vertices lie on the surface.

[[nodiscard]] Mesh unit_sphere_mesh();    ///< radius 1, 64 x 32
[[nodiscard]] Mesh unit_disk_mesh();      ///< radius 1 in the x, y plane, facing +z, 64 corners
[[nodiscard]] Mesh unit_cylinder_mesh();  ///< radius 1 around z from 0 to 1, open, facing outwards, 64 around
[[nodiscard]] Mesh unit_square_mesh();    ///< -1..1 in the x, y plane, facing +z

[[nodiscard]] Mat4d placement(const Sphere& sphere);
[[nodiscard]] Mat4d placement(const Disk& disk);
[[nodiscard]] Mat4d placement(const Cylinder& cylinder);
/// @param around the middle of what is to be seen on the plane; @param half half of the square's side, m.
[[nodiscard]] Mat4d placement(const Plane& plane, const Vec3d& around, double half);

/// The mesh of unit size of a shape's kind; a plane's is the square.
[[nodiscard]] Mesh unit_mesh(const Shape& shape);

/// The square that stands for an endless plane.
struct PlaneCut {
  Vec3d centre{0};   ///< its middle, projected onto the plane
  double half = 50;  ///< half of its side, m
};
/// Around the middle of all that is bounded, cameras too, and so large that it looks endless from there.
[[nodiscard]] PlaneCut plane_cut(const Scene& scene);

/// Where the unit mesh of a shape stands.
[[nodiscard]] Mat4d placement(const Shape& shape, const PlaneCut& cut);

/// The scene with instances of meshes in place of its exact shapes, behind its other instances: objects keep their
/// numbers.
[[nodiscard]] Scene tessellated(Scene scene);

}  // namespace penumbra
