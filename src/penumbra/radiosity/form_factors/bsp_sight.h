#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/radiosity/form_factors/bsp_tree.h"

namespace penumbra {

/// Form factors from points to what they see of a patch, by the exact order of a BSP tree.
///
/// The tree hands out fragments from front to back; each piece of the patch loses what lies in the pyramids over the
/// fragments before it, so no depths are compared. One object a thread.
class BspSight {
 public:
  explicit BspSight(const BspTree& tree) : tree_(tree) {}

  /// @param normal unit, of the element at `point`. @param blocks for each patch of the mesh, whether it may stand in
  /// between; only those are cut out.
  [[nodiscard]] double factor(const Vec3d& point, const Vec3d& normal, std::uint32_t patch,
                              const std::vector<char>& blocks);

 private:
  void cut_shadow(const Vec3d& point, std::span<const Vec3d> blocker);

  const BspTree& tree_;
  std::vector<std::span<const Vec3d>> before_;
  std::vector<std::vector<Vec3d>> pieces_, next_;
  std::vector<Vec3d> rest_, outside_, inside_;
};

}  // namespace penumbra
