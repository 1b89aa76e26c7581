#pragma once

#include <string>

#include "penumbra/render/ray_tree.h"
#include "penumbra/scene/scene.h"
#include "report.h"

namespace penumbra::cli {

/// A ray tree for reading: a line a ray, children indented below their parents.
[[nodiscard]] std::string tree_as_text(const RayTree& tree, const Scene& scene);
/// The same as JSON: an array of rays with their parents' numbers.
[[nodiscard]] Report tree_as_json(const RayTree& tree, const Scene& scene);
/// The same for Graphviz's dot.
[[nodiscard]] std::string tree_as_dot(const RayTree& tree, const Scene& scene);

/// "'floor' (front)", "the light 'lamp'", "the sky": what a ray met, or would have.
[[nodiscard]] std::string met_by(const TreeRay& ray, const Scene& scene);

}  // namespace penumbra::cli
