#pragma once

#include "penumbra/math/vec.h"

namespace penumbra {

/// Applies an affine transform to a point.
[[nodiscard]] inline Vec3d transform_point(const Mat4d& m, const Vec3d& p) { return Vec3d(m * Vec4d(p, 1.0)); }

/// Applies an affine transform to a direction; length is not kept.
[[nodiscard]] inline Vec3d transform_vector(const Mat4d& m, const Vec3d& v) { return Mat3d(m) * v; }

/// The matrix that takes normals where `m` takes points: the cofactor matrix, so it exists for
/// singular `m` too. The result needs normalising; a mirroring `m` flips it, see `is_mirroring`.
[[nodiscard]] Mat3d normal_matrix(const Mat4d& m);

/// True when `m` turns right-handed frames into left-handed ones: counter-clockwise triangles become clockwise.
[[nodiscard]] bool is_mirroring(const Mat4d& m);

/// Camera-to-world matrix of an eye that looks along its own -z with +y up.
/// @pre `eye` differs from `target`, and `up` is not parallel to their difference.
[[nodiscard]] Mat4d look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up);

}  // namespace penumbra
