#pragma once

#include "bake_arguments.h"

namespace penumbra::cli {

/// `penumbra bake` with a profile whose light lies in a texture: unlit, hdr, lightmap. Returns an ExitCode.
[[nodiscard]] int bake_lightmap(const BakeArguments& arguments);

/// What the lightmap profile writes beside the .glb: the light as it is, and what its numbers mean.
[[nodiscard]] std::string lightmap_picture_name(const std::string& output);      ///< OUT-lightmap.exr
[[nodiscard]] std::string lightmap_description_name(const std::string& output);  ///< OUT-lightmap.json
[[nodiscard]] std::string directional_picture_name(const std::string& output);   ///< OUT-directional.exr, if asked for

}  // namespace penumbra::cli
