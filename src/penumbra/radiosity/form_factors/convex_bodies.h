#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/patch_outlines.h"

namespace penumbra {

/// Parts of a mesh that bound convex solids, their fronts outwards: boxes, buildings that stand on the ground.
///
/// Whoever enters such a solid does so through a face whose front he sees, so for lines that start outside it the faces
/// seen from behind hide nothing that the others do not.
struct ConvexBodies {
  static constexpr std::uint32_t no_body = 0xffffffffU;

  std::vector<std::uint32_t> body_of;  ///< per patch
  std::vector<std::uint32_t> plane_offsets{0};
  std::vector<Plane3> planes;  ///< of each body's faces, one for each direction

  [[nodiscard]] std::size_t size() const { return plane_offsets.size() - 1; }
  [[nodiscard]] std::span<const Plane3> body_planes(std::uint32_t body) const {
    return std::span(planes).subspan(plane_offsets[body], plane_offsets[body + 1] - plane_offsets[body]);
  }
};

/// Patches joined across edges that are flat or convex, kept when all corners lie behind all faces and open edges lie
/// in one of `hull_planes`: planes with the whole mesh on one side, through which no line between patches can pass.
[[nodiscard]] ConvexBodies find_convex_bodies(const PatchMesh& mesh, const PatchOutlines& outlines,
                                              std::span<const Plane3> hull_planes, double tolerance);

}  // namespace penumbra
