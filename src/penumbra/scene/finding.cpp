#include "penumbra/scene/finding.h"

namespace penumbra {

std::string_view name_of(FindingKind kind) {
  switch (kind) {
    case FindingKind::hole:
      return "hole";
    case FindingKind::open_side:
      return "open-side";
    case FindingKind::crack:
      return "crack";
    case FindingKind::t_junction:
      return "t-junction";
    case FindingKind::flipped:
      return "flipped";
    case FindingKind::duplicate:
      return "duplicate";
    case FindingKind::overlap:
      return "overlap";
    case FindingKind::degenerate:
      return "degenerate";
    case FindingKind::reflectance:
      return "reflectance";
    case FindingKind::no_light:
      return "no-light";
    case FindingKind::scale:
      return "scale";
  }
  return "unknown";
}

}  // namespace penumbra
