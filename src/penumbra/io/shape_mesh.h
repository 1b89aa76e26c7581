#pragma once

#include "penumbra/scene/mesh.h"
#include "penumbra/scene/shape.h"

namespace penumbra {

// Exact primitives as triangles, for formats that know nothing else: a mesh of unit size with smooth normals, and where
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

}  // namespace penumbra
