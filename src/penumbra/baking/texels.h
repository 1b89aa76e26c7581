#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// The texels of an atlas that faces cover, even in part, row by row. Arrays are per texel, unless they say otherwise:
/// atlases have millions.
struct Texels {
  int width = 0, height = 0;             ///< of the atlas
  std::vector<std::uint32_t> pixels;     ///< y * width + x, ascending
  std::vector<std::uint32_t> triangles;  ///< the triangle that holds `positions`, numbered as the atlas does
  std::vector<Vec3d> positions;          ///< m: the texel's centre, or the point of the chart nearest to it
  std::vector<Vec3f> interpolated;       ///< see shading_normal(); empty where no mesh has normals
  std::vector<Vec3d> normals_of;         ///< by triangle: unit, geometric, to the front
  std::vector<double> footprints_of;     ///< by triangle, m: edge of a square of a texel's area on the surface

  [[nodiscard]] std::size_t count() const { return pixels.size(); }
  /// Unit, geometric, to the front.
  [[nodiscard]] const Vec3d& normal(std::size_t texel) const { return normals_of[triangles[texel]]; }
  /// Unit, interpolated where the mesh has normals; else as normal().
  [[nodiscard]] Vec3d shading_normal(std::size_t texel) const {
    return interpolated.empty() ? normal(texel) : normalize(Vec3d(interpolated[texel]));
  }
  /// m: edge of a square of the texel's area on the surface.
  [[nodiscard]] double footprint(std::size_t texel) const { return footprints_of[triangles[texel]]; }
};

/// Conservative rasterisation of the atlas (a texel that a triangle touches counts).
[[nodiscard]] Texels make_texels(const LightmapAtlas& atlas);

}  // namespace penumbra
