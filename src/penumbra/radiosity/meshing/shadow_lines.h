#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "penumbra/radiosity/meshing/lamp_irradiance.h"

namespace penumbra {

/// A line on a patch of the faces across which irradiance is not smooth.
struct ShadowLine {
  std::uint32_t patch = 0;
  std::array<Vec3d, 2> ends;  ///< in its plane; may stick out
  int degree = 1;             ///< 0: irradiance jumps; 1: its slope or curvature does
};

struct ShadowLineOptions {
  int rays_along_edge = 5;        ///< sent past each edge to find what lies behind
  std::size_t most_edges = 5000;  ///< of occluders, the longest ones
};

/// Where shadow boundaries fall: for each lamp rays are shot past the silhouette edges of what may stand in its light
/// (edges that only one face has, or from which one of two faces looks towards the lamp and the other away) onto the
/// faces behind, and the wedges of those edges are cut with each face that was met:
/// - D0, irradiance jumps: what touches a face or passes through it, and the shadows of points and far lights;
/// - D1 and D2: the planes through a lamp's corner and an edge, and through a corner and a lamp's edge (Heckbert 1992,
///   "Discontinuity Meshing for Radiosity"; Lischinski, Tampieri & Greenberg 1992). Curved boundaries from three skew
///   edges are left out.
[[nodiscard]] std::vector<ShadowLine> find_shadow_lines(const LampIrradiance& light,
                                                        const ShadowLineOptions& options = {});

/// Lines that jump first, then the longest: when elements run out the lesser ones are left.
[[nodiscard]] std::vector<ShadowLine> by_importance(std::vector<ShadowLine> lines);

}  // namespace penumbra
