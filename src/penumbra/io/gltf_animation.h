#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "penumbra/io/gltf_accessor.h"
#include "penumbra/io/gltf_document.h"
#include "penumbra/math/transform.h"

namespace penumbra {

/// One animation of a glTF: keys of nodes over time, between which values are interpolated (glTF 2.0, section 3.11 and
/// appendix C).
class GltfAnimation {
 public:
  /// No animation: every node is at rest.
  GltfAnimation() = default;
  /// @param choice the animation's name or index; none: the first. Throws FileError when there is none of that name,
  /// keys do not increase, or accessors do not fit their channel.
  GltfAnimation(GltfDocument& document, GltfAccessors& accessors, const std::optional<std::string>& choice);

  /// Whether any key is about this node's own place.
  [[nodiscard]] bool moves(std::uint32_t node) const;
  /// Whether any key is about its morph weights.
  [[nodiscard]] bool morphs(std::uint32_t node) const { return find(node, Path::weights) != nullptr; }

  /// A node's placement in its parent. @param time s; none: at rest. Throws FileError at `place`.
  [[nodiscard]] Mat4d to_parent(const JsonPlace& place, std::uint32_t node, std::optional<double> time) const;
  /// A node's morph weights, if the animation sets them.
  [[nodiscard]] std::optional<std::vector<double>> weights(std::uint32_t node, std::optional<double> time) const;

 private:
  enum class Path { translation, rotation, scale, weights };
  enum class Interpolation { step, linear, cubic };
  /// The keys of one property of one node.
  struct Track {
    Interpolation interpolation = Interpolation::linear;
    std::size_t width = 0;       // numbers a key
    std::vector<double> times;   // s, increasing
    std::vector<double> values;  // width a key; of a cubic one the tangent in, the value and the tangent out
    [[nodiscard]] std::vector<double> at(double time, bool is_rotation) const;
  };

  void read_channel(GltfDocument& document, GltfAccessors& accessors, const JsonPlace& animation,
                    const JsonPlace& channel);
  [[nodiscard]] const Track* find(std::uint32_t node, Path path) const;

  std::map<std::pair<std::uint32_t, Path>, Track> tracks_;
};

}  // namespace penumbra
