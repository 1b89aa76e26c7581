#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/baking/texel_energy.h"
#include "penumbra/baking/texels.h"
#include "penumbra/parallel/progress.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// Irradiance of texels, of the front of their faces. Arrays are per texel.
struct TexelLight {
  std::vector<float> irradiance;     ///< [texel * 3 + band], W/m^2, from everywhere
  std::vector<float> direct;         ///< the part of it that comes straight from lamps, points, spots, far lights
  std::vector<float> error;          ///< estimated standard error of the luminance, relative to the scene's mean
  std::vector<std::uint8_t> buried;  ///< 1 where the texel lies inside solid matter: its light is another's, or none
  bool partial = false;
  std::size_t rays = 0;  ///< traced, without shadow rays
  /// After each bounce of light that was followed: what changed, as a share of all light.
  std::vector<double> residuals;
  TexelEnergy energy;
  double noise = 0;        ///< estimated RMS error of the luminance relative to its surface's mean, over all texels
  double worst_noise = 0;  ///< the same of the surface (instance) that has most
};

class TexelSolution;

struct TexelLightOptions {
  double noise = 0.01;   ///< aimed RMS error of the luminance of each part of a surface, relative to its surface's mean
  int fewest_rays = 64;  ///< a texel, a power of 2
  int most_rays = 4096;  ///< a texel, a power of 2: where the aimed noise ends
  bool front_sides_only = false;  ///< backs are black and opaque
  bool opaque_shadows = false;    ///< glass stops the shadow rays of points, spots and far lights
  bool denoise = false;  ///< smooth what rays brought where neighbours agree within their noise (denoise_texels)
  std::uint64_t seed = 0;
  Progress progress{};
};

/// Irradiance of the front of every texel: straight light of lamps exactly, the rest by rays.
///
/// Lamps are the emissive faces without a texture (exact, shadows and all: see LampIrradiance), points, spots and far
/// lights; their light is averaged over a texel where it varies within (see StraightLight). Everything else comes by
/// low-discrepancy rays over the hemisphere: environment, textured emitters, interreflection. Each texel's first rays
/// are traced once and remembered by the texel that each hits, and light is passed along them until nothing changes: a
/// radiosity solution on the texels, or on coarser cells where there are more than fits. Then every texel gathers from
/// it by as many more rays as the aimed noise needs. Rays that meet mirrors, metal, glass or AlphaMode::blend go on, so
/// that light by way of them counts; rough metals scatter them.
///
/// Sides by the one rule: both reflect, the front emits. The atlas holds the front's light; backs that rays meet are
/// solved along. Texels inside solid matter are found, and filled from their chart's free texels nearby.
/// The same bits for any number of threads. When asked to stop it returns what it has, marked partial.
/// Throws std::invalid_argument for options out of range, and for faces that make_patch_mesh refuses.
/// @param texels of the same atlas.
[[nodiscard]] TexelLight bake_texel_light(const LightmapAtlas& atlas, const Texels& texels,
                                          const TexelLightOptions& options = {});

/// The same from a solution that serves for more: `front_sides_only` and `opaque_shadows` are as it was made. Its
/// direct() is taken away.
[[nodiscard]] TexelLight bake_texel_light(TexelSolution& solution, const TexelLightOptions& options);

}  // namespace penumbra
