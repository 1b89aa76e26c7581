#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "penumbra/io/gltf_animation.h"
#include "penumbra/io/gltf_document.h"
#include "penumbra/math/transform.h"

namespace penumbra {

/// A node of the scene that is read.
struct GltfNode {
  std::uint32_t index = 0;
  Mat4d to_world{1.0};
  bool moves = false;     ///< the animation has keys of it or of a node above it
  std::size_t depth = 1;  ///< nodes from its root to it
};

/// The scene that is read: the one chosen by name or index, else the file's default one, else its first; nothing when
/// it has no scenes. Throws FileError.
[[nodiscard]] std::optional<JsonPlace> gltf_scene(const GltfDocument& document,
                                                  const std::optional<std::string>& choice = std::nullopt);

/// The tree of a glTF's nodes, and where they are at a time of an animation.
class GltfNodes {
 public:
  struct Family {
    std::vector<std::uint32_t> parent;  // or the largest number
    std::vector<std::vector<std::uint32_t>> children;
  };

  /// Document and animation must outlive this. Throws FileError for a node with two parents or one that is its own
  /// ancestor.
  GltfNodes(const GltfDocument& document, const GltfAnimation& animation);

  /// The nodes of a scene (of all roots when there is none), parents before children, in file order.
  /// @param time s; none: at rest. Throws FileError for a transform that is not finite.
  [[nodiscard]] std::vector<GltfNode> placed(const std::optional<JsonPlace>& scene, std::optional<double> time) const;

  /// Where one node is. @pre `node` is one. Throws FileError for a transform that is not finite.
  [[nodiscard]] Mat4d to_world(std::uint32_t node, std::optional<double> time) const;

  /// Where all of them are, of every scene.
  [[nodiscard]] std::vector<Mat4d> to_world(std::optional<double> time) const;

 private:
  [[nodiscard]] Mat4d to_parent(std::uint32_t node, std::optional<double> time) const;

  const GltfDocument* document_;
  const GltfAnimation* animation_;
  Family family_;
};

}  // namespace penumbra
