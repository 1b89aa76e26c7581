#pragma once

#include <span>
#include <string>
#include <string_view>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// A scene that comes with the program.
struct BuiltinScene {
  std::string_view name;
  std::string_view parameters;   ///< "triangles=N (default 10000, 100 to 10000000)", or empty
  std::string_view description;  ///< one line
};

/// All of them, in the order that `penumbra scene --list` prints.
[[nodiscard]] std::span<const BuiltinScene> builtin_scenes();

/// Makes one from "NAME?key=value&key=value" (without the `builtin:` prefix).
/// Throws std::invalid_argument for an unknown name (naming the known ones and the nearest), an unknown key, or a value
/// out of range.
[[nodiscard]] Scene make_builtin_scene(std::string_view name_and_parameters);

}  // namespace penumbra
