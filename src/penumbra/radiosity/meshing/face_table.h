#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// The numbering of a scene's input polygons that `PatchSurface::face` uses: object by object, face by face; a round
/// shape has the polygons that stand for it.
class FaceTable {
 public:
  /// @param shape_segments as in MeshingOptions. Planes without end have no faces. The scene must outlive the table.
  FaceTable(const Scene& scene, int shape_segments);

  [[nodiscard]] std::size_t face_count() const { return first_.back(); }
  [[nodiscard]] std::uint32_t first_face(std::size_t object) const { return first_[object]; }
  /// The object that has a face.
  [[nodiscard]] std::size_t object_of(std::uint32_t face) const;
  /// The face that a hit lies on: @param object one of the scene's instances. @param triangle of its mesh.
  [[nodiscard]] std::uint32_t face_of(std::size_t object, std::uint32_t triangle) const;
  /// The triangles of its mesh that make up a face of an instance; none for a shape's.
  [[nodiscard]] std::span<const std::uint32_t> triangles(std::uint32_t face) const;
  /// The material of a face: that of its first triangle.
  [[nodiscard]] std::uint32_t material(std::uint32_t face) const;

 private:
  /// Triangles sorted by face, for each mesh.
  struct MeshFaces {
    std::vector<std::uint32_t> offsets;
    std::vector<std::uint32_t> triangles;
  };

  const Scene* scene_;
  std::vector<std::uint32_t> first_;  // by object, and the total
  std::vector<MeshFaces> meshes_;
};

}  // namespace penumbra
