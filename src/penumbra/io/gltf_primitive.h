#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "penumbra/io/draco_mesh.h"
#include "penumbra/io/gltf_accessor.h"
#include "penumbra/io/gltf_deformation.h"
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
  colour_attribute,
  joints_0_attribute,  // these four are read for skins alone, and dropped when the skin has been put on
  joints_1_attribute,
  weights_0_attribute,
  weights_1_attribute
};
inline constexpr std::size_t gltf_attribute_count = 10;

/// The triangles of one glTF primitive, checked: corners lie inside the attributes, which are of one length.
struct GltfPrimitive {
  std::vector<Mesh::Triangle> triangles;
  std::array<std::optional<GltfElements>, gltf_attribute_count> attributes;  ///< position is always there
  /// Equal for primitives that share all their vertices.
  std::array<std::int64_t, gltf_attribute_count> vertex_source{};
  std::shared_ptr<const DracoMesh> draco;            ///< holds the attributes' bytes, if it was compressed
  std::shared_ptr<const DeformedVertices> deformed;  ///< holds those that a deformation moved
  /// Whether its vertices are its own, whatever accessors it names.
  [[nodiscard]] bool is_alone() const { return draco || deformed; }
};

/// How many triangles primitive `place` asks for by its accessors' counts, before anything is read. Throws FileError.
[[nodiscard]] std::size_t declared_triangles(const GltfAccessors& accessors, const JsonPlace& place);

/// Reads primitive `place` as triangles, bent by `deformation`; nothing for points and lines, which are a warning.
/// Throws FileError.
[[nodiscard]] std::optional<GltfPrimitive> read_gltf_primitive(GltfDocument& document, GltfAccessors& accessors,
                                                               const JsonPlace& place,
                                                               const GltfDeformation& deformation);

}  // namespace penumbra
