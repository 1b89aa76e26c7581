#pragma once

#include <algorithm>

#include "penumbra/math/spectrum.h"

namespace penumbra {

/// Bounces before Russian roulette may end a path.
inline constexpr int sure_bounces = 3;

/// The chance to live on of a path that carries `throughput`. Less than one always: even in a scene that absorbs
/// nothing a path ends with probability one.
[[nodiscard]] inline double survival_chance(const Rgb& throughput) {
  return std::min(0.95, static_cast<double>(max_component(throughput)));
}

}  // namespace penumbra
