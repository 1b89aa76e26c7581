#pragma once

#include <string>

#include "penumbra/render/ray_tree.h"
#include "penumbra/scene/scene.h"

namespace penumbra::cli {

/// The rays over the scene's outline as an SVG picture: seen along that axis of the world along which they run least,
/// each with its number, and the list of them below.
[[nodiscard]] std::string tree_as_svg(const RayTree& tree, const Scene& scene, const std::string& title);

}  // namespace penumbra::cli
