#pragma once

#include <cstdint>
#include <limits>

namespace penumbra {

/// How a scene is read from a file.
struct ReadOptions {
  double unit = 1.0;           ///< metres per file unit, > 0, for formats without a unit of their own
  bool allow_outside = false;  ///< read what the file names outside its own folder, too (see AssetFolder)
  /// The most memory that what is read may take, bytes; a file that would take more is refused before it is decoded.
  std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();
};

}  // namespace penumbra
