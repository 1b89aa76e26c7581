#pragma once

#include <optional>
#include <string>
#include <vector>

#include "option_parser.h"
#include "penumbra/scene/daylight.h"
#include "penumbra/scene/scene.h"

namespace penumbra::cli {

/// What a command line adds to a scene: air, daylight, measured luminaires.
struct WorldOptions {
  struct Ies {
    std::string file;
    std::string light;  ///< name
  };
  std::optional<Medium> fog;
  std::vector<std::string> smoke;  ///< files of density grids
  std::optional<DaylightOptions> sky;
  std::vector<Ies> ies;
};

enum class WorldMedia {
  any,
  fog_alone,  ///< no density grids
};

/// Adds --fog, --smoke, --sky and --ies. `options` must outlive `parser`'s last parse.
void add_world_options(OptionParser& parser, WorldOptions& options, WorldMedia media);

/// Puts them into the scene. Throws FileError, UsageError.
void furnish(const WorldOptions& options, Scene& scene, std::vector<std::string>& warnings);

/// Baked light for viewers is that of clear air: throws UsageError when the scene holds media. @param output to name.
void refuse_air(const Scene& scene, const std::string& output);

}  // namespace penumbra::cli
