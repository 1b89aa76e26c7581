#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "penumbra/io/gltf_accessor.h"
#include "penumbra/io/gltf_deformation.h"
#include "penumbra/io/gltf_document.h"
#include "penumbra/io/gltf_primitive.h"
#include "penumbra/scene/mesh.h"

namespace penumbra {

/// Meshes of a glTF by their index.
class GltfMeshes {
 public:
  /// @param material_of scene material of a glTF material's index, or of -1: none. Document and accessors must outlive
  /// this.
  GltfMeshes(GltfDocument& document, GltfAccessors& accessors,
             std::function<std::uint32_t(std::int64_t, const JsonPlace&)> material_of)
      : document_(&document), accessors_(&accessors), material_of_(std::move(material_of)) {}

  /// Mesh `index`: its primitives become one Mesh with a material for each triangle where they have the same vertex
  /// attributes, and one Mesh for each set of attributes otherwise. Vertices that no triangle uses are left out, all
  /// others keep their order. @param deformation bends it. Throws FileError.
  [[nodiscard]] std::vector<Mesh> read(std::uint64_t index, const JsonPlace& user, const GltfDeformation& deformation);

 private:
  void check_size(std::size_t more_triangles, const JsonPlace& place) const;

  GltfDocument* document_;
  GltfAccessors* accessors_;
  std::function<std::uint32_t(std::int64_t, const JsonPlace&)> material_of_;
  std::size_t triangles_read_ = 0;
  std::vector<std::uint32_t> new_vertex_;  // scratch: where a source vertex went, or none
};

}  // namespace penumbra
