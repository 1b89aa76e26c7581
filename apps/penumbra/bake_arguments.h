#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common_options.h"
#include "radiosity_options.h"
#include "scene_options.h"

namespace penumbra::cli {

/// Everything that `penumbra bake` was asked for.
struct BakeArguments {
  SceneOptions scene;
  RadiosityOptions radiosity;
  std::string output;
  std::optional<double> exposure;  ///< stops (EV), of a .glb
  std::optional<std::string> profile;
  CommonOptions common;
};

/// Reads and checks the arguments; none when the user asked for help. Throws UsageError, FileError.
[[nodiscard]] std::optional<BakeArguments> parse_bake_arguments(const std::vector<std::string>& arguments);

}  // namespace penumbra::cli
