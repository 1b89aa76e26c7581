#pragma once

#include <optional>
#include <span>
#include <vector>

namespace penumbra {

/// Whole texels.
struct PackedSize {
  int width = 1, height = 1;
};
struct PackedPlace {
  int x = 0, y = 0;
};

/// Lays rectangles side by side, unturned, in one `width` x `height`; none when they do not fit as they are laid.
///
/// Highest first: up to some thousands at the lowest place of a skyline (Jylanki 2010, "A thousand ways to pack the
/// bin", its bottom-left rule), more than that on shelves (Coffman et al. 1980, next fit by decreasing height), in time
/// n log n. The same sizes give the same places.
[[nodiscard]] std::optional<std::vector<PackedPlace>> pack_rectangles(std::span<const PackedSize> sizes, int width,
                                                                      int height);

}  // namespace penumbra
