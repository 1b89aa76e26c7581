#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// The binary chunk of a .glb with its buffer views and accessors, as plain numbers. Little-endian machines only, as
/// all that Debian's Embree runs on.
class GlbBinary {
 public:
  /// glTF's component types and buffer targets.
  enum Component : int { u16 = 5123, u32 = 5125, f32 = 5126 };
  enum Target : int { none = 0, vertices = 34962, indices = 34963 };

  struct View {
    std::size_t offset = 0;
    std::size_t length = 0;  ///< bytes
    Target target = none;
  };
  struct Accessor {
    std::uint32_t view = 0;
    Component component = f32;
    int width = 1;  ///< components an element: 1 is SCALAR, 2 to 4 VEC2 to VEC4
    std::size_t count = 0;
    std::optional<std::array<Vec3f, 2>> range;  ///< least and greatest, for positions
  };

  /// Appends bytes at a multiple of four and returns the view's index.
  std::uint32_t add_view(std::span<const std::byte> bytes, Target target);

  // Append values and return the accessor's index.
  std::uint32_t add_positions(std::span<const Vec3f> positions);  ///< with their range
  std::uint32_t add_vectors(std::span<const Vec2f> values) { return add_floats(values, 2); }
  std::uint32_t add_vectors(std::span<const Vec3f> values) { return add_floats(values, 3); }
  std::uint32_t add_vectors(std::span<const Vec4f> values) { return add_floats(values, 4); }
  /// In 16 bits where they fit, 65535 being kept free as glTF demands.
  std::uint32_t add_indices(std::span<const std::uint32_t> values, std::size_t vertex_count);

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  [[nodiscard]] std::span<const View> views() const { return views_; }
  [[nodiscard]] std::span<const Accessor> accessors() const { return accessors_; }

 private:
  template <class Vector>
  std::uint32_t add_floats(std::span<const Vector> values, int width) {
    return add({add_view(std::as_bytes(values), vertices), f32, width, values.size(), {}});
  }
  std::uint32_t add(const Accessor& accessor);

  std::vector<std::byte> bytes_;
  std::vector<View> views_;
  std::vector<Accessor> accessors_;
};

}  // namespace penumbra
