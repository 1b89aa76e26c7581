#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// The texels of an atlas that faces cover, even in part, row by row. Arrays are per texel.
struct Texels {
  int width = 0, height = 0;             ///< of the atlas
  std::vector<std::uint32_t> pixels;     ///< y * width + x, ascending
  std::vector<std::uint32_t> triangles;  ///< the triangle that holds `positions`, numbered as the atlas does
  std::vector<Vec3d> positions;          ///< m: the texel's centre, or the point of the chart nearest to it
  std::vector<Vec3d> normals;            ///< unit, geometric, to the front
  std::vector<Vec3d> shading_normals;    ///< unit, interpolated where the mesh has normals; else as `normals`
  std::vector<double> footprints;        ///< m: edge of a square of the texel's area on the surface

  [[nodiscard]] std::size_t count() const { return pixels.size(); }
};

/// Conservative rasterisation of the atlas (a texel that a triangle touches counts).
[[nodiscard]] Texels make_texels(const LightmapAtlas& atlas);

}  // namespace penumbra
