#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace penumbra {

/// How EXT_meshopt_compression packed a buffer view.
struct MeshoptPacking {
  std::string mode;             ///< ATTRIBUTES, TRIANGLES or INDICES
  std::string filter = "NONE";  ///< NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL
  std::size_t count = 0;        ///< elements
  std::size_t stride = 0;       ///< bytes an element
};

/// The bytes of a buffer view that EXT_meshopt_compression packed: count x stride of them. What the packing claims is
/// compared with the length of the data before memory is taken.
/// Throws std::invalid_argument with what is wrong ("its meshopt data ...").
[[nodiscard]] std::vector<std::byte> decode_meshopt(std::span<const std::byte> bytes, const MeshoptPacking& packing);

}  // namespace penumbra
