#pragma once

#include "penumbra/scene/texture.h"

namespace penumbra {

/// A texture coordinate brought into [0, 1] by its wrap mode; one that is not finite counts as 0. Double keeps the
/// sixteen bits of a texel that lies far out.
[[nodiscard]] double wrapped(double coordinate, Wrap wrap);

/// The two texels of an axis around a wrapped coordinate, and the share of the second.
struct TexelPair {
  int first = 0;
  int second = 0;
  float share = 0;
};
[[nodiscard]] TexelPair texels_around(double coordinate, int size, Wrap wrap);

}  // namespace penumbra
