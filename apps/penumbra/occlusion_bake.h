#pragma once

#include "bake_arguments.h"

namespace penumbra::cli {

/// `penumbra bake --profile ao`: the scene as it is, with a texture of ambient occlusion. Returns an ExitCode.
[[nodiscard]] int bake_occlusion(const BakeArguments& arguments);

}  // namespace penumbra::cli
