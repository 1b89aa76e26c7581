#include "penumbra/math/transform.h"

#include <cassert>
#include <glm/matrix.hpp>

namespace penumbra {

Mat3d normal_matrix(const Mat4d& m) {
  const Mat3d a(m);
  return {glm::cross(a[1], a[2]), glm::cross(a[2], a[0]), glm::cross(a[0], a[1])};
}

bool is_mirroring(const Mat4d& m) { return glm::determinant(Mat3d(m)) < 0; }

Mat4d look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up) {
  assert(eye != target);
  const Vec3d back = glm::normalize(eye - target);
  const Vec3d right = glm::normalize(glm::cross(up, back));
  const Vec3d above = glm::cross(back, right);
  return {Vec4d(right, 0), Vec4d(above, 0), Vec4d(back, 0), Vec4d(eye, 1)};
}

}  // namespace penumbra
