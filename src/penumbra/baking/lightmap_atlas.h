#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "penumbra/scene/scene.h"

namespace penumbra {

struct AtlasOptions {
  int size = 0;                 ///< texels along the longer side, a multiple of 4; 0: by density
  double texels_per_metre = 0;  ///< density; 0: by size. Both 0: a size of 1024
  double chart_angle = 0.0175;  ///< rad; faces whose normals differ by more never share a chart
  /// rad; where there are so many charts that they would be mostly padding, `chart_angle` is doubled, up to this.
  double widest_chart_angle = 0.7;
  int mip_levels = 2;      ///< below the full size that must not bleed: charts keep 2^levels texels apart
  bool keep_input = true;  ///< use TEXCOORD_1 of the input where all of it is a valid lightmap
};

/// A rectangle of texels, and the faces that it shows.
struct Chart {
  int x = 0, y = 0, width = 0, height = 0;  ///< texels, without padding; every chart has at least one
  std::uint32_t object = 0;
};

/// A scene unfolded for a lightmap: every instance has a mesh of its own, whose uv[1] is its place in the atlas (0..1,
/// v downwards). Triangles are those of the input, in number, order and place; vertices are doubled at chart borders
/// only. A chart is of one object and one material. Its rectangle is the smallest around it, scaled so that its sides
/// are whole texels: at most half a texel off the density, and borders of rectangles lie on borders of texels. Textures
/// that read TEXCOORD_1 find their coordinates in TEXCOORD_0. Fronts and backs of a face share their texels: they are
/// the front's.
struct LightmapAtlas {
  Scene scene;
  int width = 0, height = 0;    ///< texels
  double texels_per_metre = 0;  ///< the density that was reached; the mean one when the input's UVs are kept
  bool from_input = false;      ///< the input's TEXCOORD_1 was valid and is used
  std::vector<Chart> charts;
  std::vector<std::uint32_t> first_triangle;     ///< by instance, and the total: triangles numbered over the scene
  std::vector<std::uint32_t> chart_of_triangle;  ///< by that number
};

/// @pre the scene has no exact shapes (see tessellated()). Throws std::invalid_argument when the charts do not fit
/// the size, an option is out of range, or a material's textures read both sets of coordinates.
[[nodiscard]] LightmapAtlas make_lightmap_atlas(Scene scene, const AtlasOptions& options = {});

}  // namespace penumbra
