#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "penumbra/io/gltf_document.h"
#include "penumbra/math/transform.h"

namespace penumbra {

/// A node of the scene that is read.
struct GltfNode {
  std::uint32_t index = 0;
  Mat4d to_world{1.0};
};

/// The scene that is read: the file's default one, else its first; nothing when it has no scenes.
[[nodiscard]] std::optional<JsonPlace> gltf_scene(const GltfDocument& document);

/// The nodes of the scene that is read (of all roots when there is none), parents before children, in file order.
/// Throws FileError for a node with two parents, a node that is its own ancestor, a transform that is not finite.
[[nodiscard]] std::vector<GltfNode> placed_gltf_nodes(GltfDocument& document);

}  // namespace penumbra
