#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "penumbra/io/gltf_document.h"

namespace penumbra {

/// glTF's component types by their numbers in the file.
enum class GltfComponent { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

/// Bytes of one component.
[[nodiscard]] std::size_t component_size(GltfComponent type);

/// Elements of 1 to 4 components, or of 16, in memory, checked: every element lies inside.
struct GltfElements {
  const std::byte* data = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;  ///< bytes
  int components = 1;
  GltfComponent type = GltfComponent::float32;
  bool normalised = false;

  /// Component c of element i; normalised integers by max(c / 127, -1) and its like (glTF 2.0, section 3.11).
  /// @pre i < count, c < components.
  [[nodiscard]] double value(std::size_t i, int c) const;
  /// Component c of element i of an unsigned integer type, as it is.
  [[nodiscard]] std::uint32_t index(std::size_t i, int c = 0) const;
};

/// Accessors by their index: bounds, types and sparse substitutions are seen to once.
class GltfAccessors {
 public:
  explicit GltfAccessors(GltfDocument& document) : document_(&document) {}

  /// Throws FileError at the accessor, or at `user` when there is none of that index. The elements live as long as
  /// this.
  [[nodiscard]] const GltfElements& elements(std::uint64_t index, const JsonPlace& user);

  struct Shape {
    std::size_t count = 0;
    int components = 1;
    GltfComponent type = GltfComponent::float32;
    bool normalised = false;
  };
  /// What the accessor says of itself, without its bytes (Draco holds them elsewhere).
  [[nodiscard]] Shape shape(std::uint64_t index, const JsonPlace& user) const;

 private:
  [[nodiscard]] GltfElements read(std::uint64_t index, const JsonPlace& user);
  void substitute(const JsonPlace& sparse, GltfElements& elements);
  /// Elements of their own, zero at first.
  [[nodiscard]] std::byte* own(std::size_t bytes, const JsonPlace& place);

  GltfDocument* document_;
  std::vector<std::optional<GltfElements>> read_;
  std::vector<std::vector<std::byte>> owned_;
  std::size_t owned_bytes_ = 0;
};

}  // namespace penumbra
