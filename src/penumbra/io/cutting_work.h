#pragma once

#include <cstddef>

namespace penumbra {

/// How much of a file's time goes into cutting large polygons, which takes the square of their corners: a file of some
/// megabytes could ask for hours.
class CuttingWork {
 public:
  /// Counts a polygon that is to be cut; false when it and those before are more than a file may ask for: eight of
  /// 8,192 corners, or as much in smaller ones. Polygons of up to 256 corners are not counted.
  [[nodiscard]] bool allows(std::size_t corners) {
    constexpr std::size_t small = 256;
    constexpr std::size_t most = 8 * std::size_t{8192} * 8192;
    if (corners > small) squares_ += corners * corners;
    return squares_ <= most;
  }

 private:
  std::size_t squares_ = 0;
};

}  // namespace penumbra
