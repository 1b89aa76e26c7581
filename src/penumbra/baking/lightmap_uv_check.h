#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// Corners in texture coordinates.
using UvTriangle = std::array<Vec2d, 3>;

/// Two triangles whose insides overlap by more than `tolerance` in every direction, in the unit of the coordinates;
/// none when there are none. Triangles that share an edge or a corner do not overlap, nor does one without an area.
[[nodiscard]] std::optional<std::array<std::uint32_t, 2>> find_overlap(std::span<const UvTriangle> triangles,
                                                                       double tolerance);

/// Why the scene's TEXCOORD_1 is no lightmap, in words; none when it is one: every mesh has it, all of it lies in 0..1,
/// no triangle that has an area in the world has none there, and no two triangles of all instances overlap.
[[nodiscard]] std::optional<std::string> lightmap_uv_fault(const Scene& scene);

}  // namespace penumbra
