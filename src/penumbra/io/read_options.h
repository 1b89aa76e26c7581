#pragma once

namespace penumbra {

/// How a scene is read from a file.
struct ReadOptions {
  double unit = 1.0;           ///< metres per file unit, > 0, for formats without a unit of their own
  bool allow_outside = false;  ///< read what the file names outside its own folder, too (see AssetFolder)
};

}  // namespace penumbra
