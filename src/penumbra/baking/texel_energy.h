#pragma once

namespace penumbra {

class TexelSolution;

/// Where the light of a solved atlas goes, W, summed over bands.
///
/// A texel stands for its share of its chart's area. What is absorbed is summed over the cells, whose light is found by
/// rays, so the terms have those rays' noise.
struct TexelEnergy {
  double emitted = 0;   ///< by faces, points and spots; of far lights and the environment what reaches the scene
  double absorbed = 0;  ///< by surfaces as they reflect diffusely, backs that are black left out
  double absorbed_by_backs = 0;  ///< when they are black
  double unshot = 0;             ///< still to come when the bounces ended
  double escaped = 0;            ///< the rest: what leaves the scene, and what mirrors, metals and glass absorb
};

[[nodiscard]] TexelEnergy texel_energy(const TexelSolution& solution);

}  // namespace penumbra
