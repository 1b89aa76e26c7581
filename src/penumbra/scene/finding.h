#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "penumbra/math/vec.h"

namespace penumbra {

/// What can be wrong with a scene although it can be read.
enum class FindingKind {
  hole,         ///< the surface stops, and begins again on the other side
  open_side,    ///< an enclosure without one of its sides
  crack,        ///< a narrow gap between edges that should meet
  t_junction,   ///< a corner that lies beside a neighbour's edge and not on it
  flipped,      ///< neighbours that face opposite ways
  duplicate,    ///< the same face twice
  overlap,      ///< faces that lie in one plane over each other
  degenerate,   ///< faces without area
  reflectance,  ///< a material that sends on more than it receives
  no_light,     ///< nothing shines
  scale,        ///< a size that suggests a wrong unit
};

/// "hole", "open-side", "t-junction", ...: as the command line and its reports name it.
[[nodiscard]] std::string_view name_of(FindingKind kind);

/// One thing to look at.
struct Finding {
  FindingKind kind = FindingKind::hole;
  std::string sentence;     ///< what is wrong, where, and what to do
  Vec3d position{0};        ///< where it is worst, world space, m; the scene's middle where no place is meant
  std::string object;       ///< the object or material that it is about; may be empty
  std::size_t count = 1;    ///< how many edges, faces or materials were put together
  double size = 0;          ///< m: the diameter of a hole, the width of a gap; else 0
  bool deliberate = false;  ///< likely meant so, such as the side through which the camera looks: a note, no fault
};

}  // namespace penumbra
