#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// The faces of a whole scene in world space, joined where corners have equal positions, and the edges between them.
/// Exact shapes (spheres, disks, cylinders, planes) are left out: they have no seams.
struct FaceNet {
  /// An edge from a lower to a higher vertex number, and the faces along it.
  struct Edge {
    std::uint32_t from = 0, to = 0;    ///< as its first face runs through it, counter-clockwise
    std::vector<std::uint32_t> faces;  ///< in ascending order
    std::vector<bool> along;           ///< whether each face runs from `from` to `to`
  };

  std::vector<Vec3d> vertices;                          ///< m, world
  std::vector<std::vector<std::uint32_t>> rings;        ///< corners of each face, counter-clockwise from the front
  std::vector<Vec3d> normals;                           ///< of each face, unit; zero where it has no area
  std::vector<std::uint32_t> object_of;                 ///< each face's object, as Scene numbers them
  std::vector<std::uint32_t> number_in_object;          ///< each face's number within its object, from 0
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< corners
  std::vector<std::uint32_t> face_of_triangle;
  std::vector<Edge> edges;

  [[nodiscard]] std::vector<Vec3d> polygon(std::uint32_t face) const;
  [[nodiscard]] double edge_length(const Edge& e) const { return length(vertices[e.to] - vertices[e.from]); }
};

[[nodiscard]] FaceNet make_face_net(const Scene& scene);

}  // namespace penumbra
