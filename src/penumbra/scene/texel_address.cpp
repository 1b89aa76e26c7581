#include "penumbra/scene/texel_address.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

double wrapped(double coordinate, Wrap wrap) {
  if (!std::isfinite(coordinate)) return 0;
  if (wrap == Wrap::clamp) return std::clamp(coordinate, 0.0, 1.0);
  if (wrap == Wrap::repeat) return coordinate - std::floor(coordinate);
  const double folded = coordinate - 2 * std::floor(coordinate / 2);
  return folded > 1 ? 2 - folded : folded;
}

TexelPair texels_around(double coordinate, int size, Wrap wrap) {
  const double position = coordinate * size - 0.5;  // texel centres lie at half integers
  const double lower = std::floor(position);
  const int first = static_cast<int>(lower);
  const auto inside = [&](int i) { return wrap == Wrap::repeat ? (i + size) % size : std::clamp(i, 0, size - 1); };
  return {inside(first), inside(first + 1), static_cast<float>(position - lower)};
}

}  // namespace penumbra
