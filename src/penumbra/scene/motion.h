#pragma once

#include <functional>
#include <vector>

#include "penumbra/math/transform.h"

namespace penumbra {

/// Where something that moves is while the shutter is open: its placements at even steps of that time, from opening to
/// closing. Between two of them each entry of the matrix changes evenly, so that a turn of angle a from one step to the
/// next shrinks by 1 - cos(a / 2) half way. Empty for what rests; else 2 to `most_motion_steps`.
using Motion = std::vector<Mat4d>;

inline constexpr std::size_t most_motion_steps = 129;

/// The placement at a time, 0 (opening) to 1 (closing). @pre not empty.
[[nodiscard]] Mat4d placement_at(const Motion& motion, double time);

/// A motion as few even steps as keep it within `tolerance` of the truth half way between them (the largest entry of
/// the difference, relative to the largest of the placement), or as many as there may be; empty when nothing moves.
/// @param placement by time, 0 to 1.
[[nodiscard]] Motion sampled_motion(const std::function<Mat4d(double time)>& placement, double tolerance = 1e-6);

}  // namespace penumbra
