#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "penumbra/io/draco_mesh.h"
#include "penumbra/io/gltf_accessor.h"
#include "penumbra/io/gltf_document.h"
#include "penumbra/scene/mesh.h"

namespace penumbra {

/// The vertex attributes that are read, in the order of `GltfPrimitive::attributes`.
enum GltfAttribute : std::size_t {
  position_attribute,
  normal_attribute,
  tangent_attribute,
  uv_0_attribute,
  uv_1_attribute,
  colour_attribute
};
inline constexpr std::size_t gltf_attribute_count = 6;

/// The triangles of one glTF primitive, checked: corners lie inside the attributes, which are of one length.
struct GltfPrimitive {
  std::vector<Mesh::Triangle> triangles;
  std::array<std::optional<GltfElements>, gltf_attribute_count> attributes;  ///< position is always there
  /// Equal for primitives that share all their vertices.
  std::array<std::int64_t, gltf_attribute_count> vertex_source{};
  std::shared_ptr<const DracoMesh> draco;  ///< holds the attributes' bytes, if it was compressed
};

/// How many triangles primitive `place` asks for by its accessors' counts, before anything is read. Throws FileError.
[[nodiscard]] std::size_t declared_triangles(const GltfAccessors& accessors, const JsonPlace& place);

/// Reads primitive `place` as triangles; nothing for points and lines, which are a warning. Throws FileError.
[[nodiscard]] std::optional<GltfPrimitive> read_gltf_primitive(GltfDocument& document, GltfAccessors& accessors,
                                                               const JsonPlace& place);

}  // namespace penumbra
