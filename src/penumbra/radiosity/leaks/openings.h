#pragma once

#include <vector>

#include "penumbra/radiosity/leaks/border.h"

namespace penumbra {

/// A run of open border edges: what is left when a surface stops.
struct Opening {
  enum class Kind {
    hole,     ///< the surface goes on beyond it
    side,     ///< the rim of an open box: surfaces stand around it
    outline,  ///< the outer edge of a sheet
  };
  Kind kind = Kind::hole;
  Vec3d centre{0};         ///< m
  Vec3d normal{0, 0, 1};   ///< unit, of the plane that fits it
  double size = 0;         ///< the diagonal of its box, m
  double area = 0;         ///< m^2
  std::uint32_t face = 0;  ///< one of those around it
};

/// Chains the open edges of a border into loops and judges each by how its faces stand to the loop's own plane.
[[nodiscard]] std::vector<Opening> find_openings(const FaceNet& net, const std::vector<BorderEdge>& border);

}  // namespace penumbra
