#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/io/gltf_accessor.h"

namespace penumbra {

/// The values of one vertex attribute, tightly packed.
struct DracoAttribute {
  std::uint32_t id = 0;  ///< Draco's unique id, by which glTF names it
  int components = 1;    ///< 1 to 4
  GltfComponent type = GltfComponent::float32;
  std::vector<std::byte> values;  ///< of every vertex
};

/// What a Draco bitstream holds of a triangle mesh.
struct DracoMesh {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< into the vertices, checked
  std::size_t vertex_count = 0;
  std::vector<DracoAttribute> attributes;
};

/// Decompresses those attributes of a Draco mesh that `wanted` names by unique id.
/// Sizes that the bitstream claims are compared with its length before anything is allocated.
/// Throws std::invalid_argument with what is wrong ("its Draco data ...").
[[nodiscard]] DracoMesh decode_draco(std::span<const std::byte> bytes, std::span<const std::uint32_t> wanted);

}  // namespace penumbra
