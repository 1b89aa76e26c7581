#include "penumbra/scene/builtin_solids.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "penumbra/math/rng.h"

namespace penumbra {

namespace {

using Index = std::uint32_t;

void add_quad(Piece& piece, Index a, Index b, Index c, Index d) {
  piece.triangles.push_back({a, b, c});
  piece.triangles.push_back({a, c, d});
}

/// Joins consecutive closed loops of `count` vertices each, the first loop at vertex `first`.
void join_loops(Piece& piece, Index first, Index count, Index loops) {
  for (Index j = 0; j + 1 < loops; ++j) {
    const Index below = first + j * count;
    for (Index i = 0; i < count; ++i) {
      const Index next = i + 1 == count ? 0 : i + 1;
      add_quad(piece, below + i, below + next, below + count + next, below + count + i);
    }
  }
}

/// Area-weighted vertex normals.
void smooth(Piece& piece) {
  std::vector<Vec3d> sum(piece.positions.size(), Vec3d(0));
  for (const Mesh::Triangle& t : piece.triangles) {
    const Vec3d area =
        cross(piece.positions[t[1]] - piece.positions[t[0]], piece.positions[t[2]] - piece.positions[t[0]]);
    for (const Index v : t) sum[v] += area;
  }
  piece.normals.reserve(sum.size());
  for (const Vec3d& n : sum) piece.normals.emplace_back(normalize(n));
}

}  // namespace

Piece BoxSolid::build() const {
  Piece piece;
  for (int corner = 0; corner < 8; ++corner) {
    piece.positions.emplace_back((corner & 1) ? upper.x : lower.x, (corner & 2) ? upper.y : lower.y,
                                 (corner & 4) ? upper.z : lower.z);
  }
  constexpr std::array<std::array<Index, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& f : faces) add_quad(piece, f[0], f[1], f[2], f[3]);
  return piece;
}

Piece LatheSolid::build() const {
  const auto count = static_cast<Index>(segments);
  const auto rings = static_cast<Index>(profile.size());
  Piece piece;
  piece.positions.reserve(std::size_t{count} * rings + 2);
  piece.triangles.reserve(triangles());
  CounterRng random(hash_key(count, rings));
  for (const Vec2d& p : profile) {
    // Flutes end in round tips: their depth grows from zero within half a flute's width of each end.
    const double inside = std::min(p.y - flute_bottom, flute_top - p.y);
    const double width = flutes > 0 ? 2 * std::numbers::pi * p.x / flutes : 1;
    const double depth = flutes > 0 && inside > 0 ? flute_depth * std::min(1.0, std::sqrt(inside / width)) : 0;
    for (Index i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count;
      double r = p.x - depth * std::abs(std::sin(flutes * angle / 2));
      double y = p.y;
      if (roughness > 0) {
        r += roughness * (2 * random.next() - 1);
        y += roughness * (random.next() - 0.5);
      }
      piece.positions.emplace_back(r * std::sin(angle), y, r * std::cos(angle));
    }
  }
  join_loops(piece, 0, count, rings);
  smooth(piece);  // before the ends close it: they are flat, and the wall keeps its own normals up to them
  const auto bottom = static_cast<Index>(piece.positions.size());
  piece.positions.emplace_back(0, profile.front().y, 0);
  piece.positions.emplace_back(0, profile.back().y, 0);
  piece.normals.emplace_back(0, -1, 0);
  piece.normals.emplace_back(0, 1, 0);
  const Index last = (rings - 1) * count;
  for (Index i = 0; i < count; ++i) {
    const Index next = i + 1 == count ? 0 : i + 1;
    piece.triangles.push_back({bottom, next, i});
    piece.triangles.push_back({bottom + 1, last + i, last + next});
  }
  return piece;
}

Piece FrameSolid::build() const {
  const auto count = static_cast<Index>(section.size());
  Piece piece;
  constexpr std::array<Vec2d, 4> corners{{{1, 1}, {1, -1}, {-1, -1}, {-1, 1}}};  // counter-clockwise from above
  for (const Vec2d& corner : corners) {
    for (const Vec2d& s : section) {
      piece.positions.emplace_back(corner.x * (half_x + s.x), s.y, corner.y * (half_z + s.x));
    }
  }
  for (Index j = 0; j < 4; ++j) {
    const Index here = j * count;
    const Index there = (j + 1) % 4 * count;
    for (Index i = 0; i < count; ++i) {
      const Index next = i + 1 == count ? 0 : i + 1;
      add_quad(piece, here + i, there + i, there + next, here + next);
    }
  }
  return piece;
}

Piece ArcSolid::build() const {
  Piece piece;
  const auto count = static_cast<Index>(segments);
  for (Index i = 0; i <= count; ++i) {
    const double angle = begin + (end - begin) * i / count;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    piece.positions.emplace_back(outer * c, outer * s, half_width);
    piece.positions.emplace_back(outer * c, outer * s, -half_width);
    piece.positions.emplace_back(inner * c, inner * s, -half_width);
    piece.positions.emplace_back(inner * c, inner * s, half_width);
  }
  join_loops(piece, 0, 4, count + 1);
  const Index last = 4 * count;
  add_quad(piece, 3, 2, 1, 0);
  add_quad(piece, last, last + 1, last + 2, last + 3);
  return piece;
}

Piece SpandrelSolid::build() const {
  Piece piece;
  const Index count = static_cast<Index>(segments) + 3;  // columns of four vertices from left to right
  for (Index i = 0; i < count; ++i) {
    Vec2d p(i == 0 ? -half_span : half_span, 0);
    if (i > 0 && i + 1 < count) {
      const double angle = std::numbers::pi * (1 - (i - 1.0) / segments);
      p = {radius * std::cos(angle), radius * std::sin(angle)};
    }
    piece.positions.emplace_back(p.x, p.y, half_thickness);
    piece.positions.emplace_back(p.x, p.y, -half_thickness);
    piece.positions.emplace_back(p.x, top, -half_thickness);
    piece.positions.emplace_back(p.x, top, half_thickness);
  }
  join_loops(piece, 0, 4, count);
  const Index last = 4 * (count - 1);
  add_quad(piece, 3, 2, 1, 0);
  add_quad(piece, last, last + 1, last + 2, last + 3);
  return piece;
}

Piece ClothSolid::build() const {
  constexpr double half_thickness = 0.006;
  const auto columns = static_cast<Index>(across) + 1;
  const auto rows = static_cast<Index>(down) + 1;
  Piece piece;
  for (const double side : {1.0, -1.0}) {
    for (Index j = 0; j < rows; ++j) {
      for (Index i = 0; i < columns; ++i) {
        const double u = static_cast<double>(i) / across;
        const double v = static_cast<double>(j) / down;
        const double fold = std::sin(2 * std::numbers::pi * (2.5 * u + 0.15 * std::sin(5 * v + phase)) + phase);
        const double sway = 0.4 * std::sin(3 * v + 2 * phase);
        piece.positions.emplace_back(half_width * (2 * u - 1) * (1 - 0.06 * v),
                                     -height * v - 0.05 * height * v * std::abs(2 * u - 1),
                                     fold_depth * (0.25 + 0.75 * v) * (fold + sway) + side * half_thickness);
      }
    }
  }
  const Index back = columns * rows;
  for (Index j = 0; j + 1 < rows; ++j) {
    for (Index i = 0; i + 1 < columns; ++i) {
      const Index a = j * columns + i;
      add_quad(piece, a, a + columns, a + columns + 1, a + 1);
      add_quad(piece, back + a, back + a + 1, back + a + columns + 1, back + a + columns);
    }
  }
  const auto hem = [&](Index a, Index b) { add_quad(piece, a, b, back + b, back + a); };
  for (Index i = 0; i + 1 < columns; ++i) {
    hem(i, i + 1);
    hem((rows - 1) * columns + i + 1, (rows - 1) * columns + i);
  }
  for (Index j = 0; j + 1 < rows; ++j) {
    hem((j + 1) * columns, j * columns);
    hem(j * columns + columns - 1, (j + 1) * columns + columns - 1);
  }
  smooth(piece);
  return piece;
}

void append(Mesh& mesh, const Piece& piece, const Placement& placement) {
  assert(mesh.positions.empty() || mesh.normals.empty() == piece.normals.empty());
  const double c = std::cos(placement.turn);
  const double s = std::sin(placement.turn);
  const auto base = static_cast<Index>(mesh.positions.size());
  for (const Vec3d& p : piece.positions) {
    mesh.positions.push_back(placement.offset + Vec3d(c * p.x + s * p.z, p.y, c * p.z - s * p.x));
  }
  const auto cf = static_cast<float>(c);
  const auto sf = static_cast<float>(s);
  for (const Vec3f& n : piece.normals) mesh.normals.emplace_back(cf * n.x + sf * n.z, n.y, cf * n.z - sf * n.x);
  for (const Mesh::Triangle& t : piece.triangles) mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
}

}  // namespace penumbra
