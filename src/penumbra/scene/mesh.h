#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Triangles in object space, metres, counter-clockwise seen from the front. Arrays that are per vertex
/// are empty or as long as `positions`.
///
/// Input polygons are kept beside their triangles: `face_vertices[face_offsets[f] .. face_offsets[f+1])`
/// are the corners of face f, and `face_of_triangle[t]` says whose part triangle t is. When `face_offsets`
/// is empty each triangle is its own face.
struct Mesh {
  using Triangle = std::array<std::uint32_t, 3>;

  std::string name;
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> materials{0};  ///< into Scene::materials; one for all triangles, or one each

  std::vector<Vec3f> normals;   ///< unit, per vertex
  std::vector<Vec4f> tangents;  ///< xyz unit, w = +-1 handedness (glTF), per vertex
  std::vector<Vec2f> uv[2];     ///< per vertex, v downwards as in glTF
  std::vector<Vec4f> colours;   ///< linear, multiplies base colour, per vertex

  std::vector<std::uint32_t> face_offsets;
  std::vector<std::uint32_t> face_vertices;
  std::vector<std::uint32_t> face_of_triangle;
  std::vector<std::uint32_t>
      face_lines;        ///< line of the file on which each face stands, from 1; empty in binary formats
  std::string extras{};  ///< as Instance::extras

  [[nodiscard]] std::uint32_t material_of(std::size_t triangle) const {
    return materials.size() == 1 ? materials[0] : materials[triangle];
  }
  [[nodiscard]] std::size_t face_count() const {
    return face_offsets.empty() ? triangles.size() : face_offsets.size() - 1;
  }
  /// The corners of a face, as indices into `positions`.
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t f) const {
    if (face_offsets.empty()) return triangles[f];
    return std::span(face_vertices).subspan(face_offsets[f], face_offsets[f + 1] - face_offsets[f]);
  }
  [[nodiscard]] Bounds bounds() const {
    Bounds b;
    for (const Vec3d& p : positions) b.grow(p);
    return b;
  }
};

}  // namespace penumbra
