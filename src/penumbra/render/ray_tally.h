#pragma once

#include <algorithm>
#include <cstdint>

#include "penumbra/render/render.h"

namespace penumbra {

/// What a ray was traced for.
enum class RayPurpose { primary, shadow, reflection, refraction, diffuse };

/// Deepest level counted by itself; deeper rays are added to it.
inline constexpr std::size_t counted_depths = 64;

/// Counts `rays` rays of one purpose at one depth.
inline void count(RayCounts& counts, RayPurpose purpose, int depth, std::uint64_t rays = 1) {
  switch (purpose) {
    case RayPurpose::primary:
      counts.primary += rays;
      break;
    case RayPurpose::shadow:
      counts.shadow += rays;
      break;
    case RayPurpose::reflection:
      counts.reflection += rays;
      break;
    case RayPurpose::refraction:
      counts.refraction += rays;
      break;
    case RayPurpose::diffuse:
      counts.diffuse += rays;
      break;
  }
  if (rays == 0) return;
  const auto level = std::min(static_cast<std::size_t>(depth), counted_depths - 1);
  if (counts.by_depth.size() <= level) counts.by_depth.resize(level + 1, 0);
  counts.by_depth[level] += rays;
}

inline RayCounts& operator+=(RayCounts& sum, const RayCounts& more) {
  sum.primary += more.primary;
  sum.shadow += more.shadow;
  sum.reflection += more.reflection;
  sum.refraction += more.refraction;
  sum.diffuse += more.diffuse;
  sum.by_depth.resize(std::max(sum.by_depth.size(), more.by_depth.size()), 0);
  for (std::size_t i = 0; i < more.by_depth.size(); ++i) sum.by_depth[i] += more.by_depth[i];
  return sum;
}

}  // namespace penumbra
