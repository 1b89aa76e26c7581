#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/radiosity/meshing/shadow_lines.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// What shoots: faces cut into coarse, even pieces. A cell's back follows its front.
struct ShootingPatches {
  PatchMesh mesh;
  std::vector<std::uint32_t> face_of;  ///< of each patch: the face it is a piece of
};

/// Cuts faces into cells no longer than `size` (m), and along the lines where light jumps, so that what lies under a
/// box is no part of what shines beside it. @param least_size shortest edge that such a cut may leave, m.
[[nodiscard]] ShootingPatches make_shooting_patches(const PatchMesh& faces, std::span<const ShadowLine> lines,
                                                    double size, double least_size);

}  // namespace penumbra
