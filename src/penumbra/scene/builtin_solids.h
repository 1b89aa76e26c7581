#pragma once

#include <cstddef>
#include <variant>
#include <vector>

#include "penumbra/scene/mesh.h"

namespace penumbra {

// Closed solids that built-in scenes are composed of: every edge is shared by two triangles, fronts face outwards, so
// solids may overlap freely and a hall made of them has no holes. Each knows its size before it is built.

/// Triangles of one solid, with smooth normals or none.
struct Piece {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;
  std::vector<Mesh::Triangle> triangles;
};

/// A box on the axes.
struct BoxSolid {
  Vec3d lower{-1};
  Vec3d upper{1};
  [[nodiscard]] std::size_t triangles() const { return 12; }
  [[nodiscard]] Piece build() const;
};

/// A profile turned about the y axis, closed by a pole at each end.
struct LatheSolid {
  std::vector<Vec2d> profile;              ///< (radius > 0, y) from bottom to top, two or more
  int segments = 8;                        ///< around, 3 or more
  int flutes = 0;                          ///< grooves around
  double flute_depth = 0;                  ///< m
  double flute_bottom = 0, flute_top = 0;  ///< y of their ends
  double roughness = 0;                    ///< m, random displacement of each vertex (a bush)
  [[nodiscard]] std::size_t triangles() const { return 2 * static_cast<std::size_t>(segments) * profile.size(); }
  [[nodiscard]] Piece build() const;
};

/// A moulding led around a rectangle in the x, z plane, mitred at the corners.
struct FrameSolid {
  std::vector<Vec2d> section;     ///< (outwards, y) counter-clockwise, x to the right
  double half_x = 1, half_z = 1;  ///< m, of the rectangle
  [[nodiscard]] std::size_t triangles() const { return 8 * section.size(); }
  [[nodiscard]] Piece build() const;
};

/// A bar of rectangular section bent to an arc in the x, y plane about the origin, from angle `begin` to `end`.
struct ArcSolid {
  double inner = 1, outer = 1.2;              ///< m, radii
  double half_width = 0.1;                    ///< m, along z
  double begin = 0, end = 3.141592653589793;  ///< rad, from +x towards +y
  int segments = 8;
  [[nodiscard]] std::size_t triangles() const { return 8 * static_cast<std::size_t>(segments) + 4; }
  [[nodiscard]] Piece build() const;
};

/// A slab of wall in the x, y plane over a round arch: from x = -half_span to half_span, y = 0 (the springing) to top.
struct SpandrelSolid {
  double half_span = 1.5, radius = 1.1, top = 1.6, half_thickness = 0.3;  ///< m, radius < half_span and top
  int segments = 8;                                                       ///< of the arch
  [[nodiscard]] std::size_t triangles() const { return 8 * (static_cast<std::size_t>(segments) + 2) + 4; }
  [[nodiscard]] Piece build() const;
};

/// A cloth that hangs in the x, y plane from y = 0 down to -height, in folds that deepen downwards.
struct ClothSolid {
  double half_width = 0.7, height = 2.5;  ///< m
  double fold_depth = 0.1;                ///< m
  double phase = 0;                       ///< rad, of the folds
  int across = 4, down = 4;
  [[nodiscard]] std::size_t triangles() const {
    return 4 * static_cast<std::size_t>(across) * static_cast<std::size_t>(down) +
           4 * static_cast<std::size_t>(across + down);
  }
  [[nodiscard]] Piece build() const;
};

using Solid = std::variant<BoxSolid, LatheSolid, FrameSolid, ArcSolid, SpandrelSolid, ClothSolid>;

/// Where a copy stands: turned about +y, then moved.
struct Placement {
  Vec3d offset{0};
  double turn = 0;  ///< rad
};

/// Appends a copy. A mesh holds pieces with normals or pieces without, not both.
void append(Mesh& mesh, const Piece& piece, const Placement& placement);

}  // namespace penumbra
