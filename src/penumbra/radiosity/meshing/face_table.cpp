#include "penumbra/radiosity/meshing/face_table.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "penumbra/radiosity/shape_polygons.h"

namespace penumbra {

FaceTable::FaceTable(const Scene& scene, int shape_segments) : scene_(&scene), first_{0} {
  for (const Mesh& mesh : scene.meshes) {
    MeshFaces& faces = meshes_.emplace_back();
    faces.triangles.resize(mesh.triangles.size());
    std::iota(faces.triangles.begin(), faces.triangles.end(), 0U);
    faces.offsets.assign(mesh.face_count() + 1, 0);
    const auto face_of_triangle = [&](std::uint32_t t) {
      return mesh.face_offsets.empty() ? t : mesh.face_of_triangle[t];
    };
    for (const std::uint32_t t : faces.triangles) ++faces.offsets[face_of_triangle(t) + 1];
    std::partial_sum(faces.offsets.begin(), faces.offsets.end(), faces.offsets.begin());
    std::stable_sort(faces.triangles.begin(), faces.triangles.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return face_of_triangle(a) < face_of_triangle(b); });
  }
  for (const Instance& instance : scene.instances) {
    first_.push_back(first_.back() + static_cast<std::uint32_t>(scene.meshes[instance.mesh].face_count()));
  }
  for (const ShapeObject& shape : scene.shapes) {
    const bool endless = std::holds_alternative<Plane>(shape.shape) || shape_segments < 3;
    const std::size_t count = endless ? 0 : shape_polygons(shape.shape, shape_segments).size();
    first_.push_back(first_.back() + static_cast<std::uint32_t>(count));
  }
}

std::size_t FaceTable::object_of(std::uint32_t face) const {
  assert(face < face_count());
  return static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), face) - first_.begin()) - 1;
}

std::uint32_t FaceTable::face_of(std::size_t object, std::uint32_t triangle) const {
  const Mesh& mesh = scene_->meshes[scene_->instances[object].mesh];
  return first_[object] + (mesh.face_offsets.empty() ? triangle : mesh.face_of_triangle[triangle]);
}

std::span<const std::uint32_t> FaceTable::triangles(std::uint32_t face) const {
  const std::size_t object = object_of(face);
  if (object >= scene_->instances.size()) return {};
  const MeshFaces& faces = meshes_[scene_->instances[object].mesh];
  const std::uint32_t within = face - first_[object];
  return std::span(faces.triangles).subspan(faces.offsets[within], faces.offsets[within + 1] - faces.offsets[within]);
}

std::uint32_t FaceTable::material(std::uint32_t face) const {
  const std::size_t object = object_of(face);
  if (object >= scene_->instances.size()) return scene_->shapes[object - scene_->instances.size()].material;
  const Mesh& mesh = scene_->meshes[scene_->instances[object].mesh];
  const auto own = triangles(face);
  return mesh.material_of(own.empty() ? 0 : own.front());
}

}  // namespace penumbra
