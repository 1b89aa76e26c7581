#pragma once

#include "bake_arguments.h"

namespace penumbra::cli {

/// `penumbra bake --probes`: light at a grid of points in space. Returns an ExitCode.
[[nodiscard]] int bake_probe_grid(const BakeArguments& arguments);

/// The arrays that are written beside the .json: OUT.npz.
[[nodiscard]] std::string probe_arrays_name(const std::string& output);

}  // namespace penumbra::cli
