#pragma once

#include <optional>
#include <string>

namespace penumbra {

/// While this time the shutter is open, s.
struct Shutter {
  double opens = 0;
  double closes = 0;  ///< >= opens
};

/// How a scene is read from a file, and what of it where the file leaves a choice.
struct ReadOptions {
  double unit = 1.0;           ///< metres per file unit, > 0, for formats without a unit of their own
  bool allow_outside = false;  ///< read what the file names outside its own folder, too (see AssetFolder)

  std::optional<std::string> scene = std::nullopt;      ///< glTF: a scene's name or index; none: the default one
  std::optional<std::string> animation = std::nullopt;  ///< glTF: name or index of the one played; none: the first
  /// The instant of the animation that is shown, s; before its first key and after its last it stands still. None: all
  /// is at rest, as the file has it without its animations.
  std::optional<double> time = std::nullopt;
  /// Objects and cameras get the motion that they make meanwhile, and stand where they are in its middle.
  std::optional<Shutter> shutter = std::nullopt;

  /// Whether an animation is played at all.
  [[nodiscard]] bool plays() const { return time || shutter; }
  /// The instant at which what does not move as a whole is read, s.
  [[nodiscard]] double instant() const { return shutter ? (shutter->opens + shutter->closes) / 2 : time.value_or(0); }
};

}  // namespace penumbra
