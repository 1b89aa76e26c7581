#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "penumbra/baking/light_cells.h"
#include "penumbra/baking/straight_light.h"
#include "penumbra/baking/texel_rays.h"
#include "penumbra/parallel/progress.h"

namespace penumbra {

/// The light of an unfolded scene, solved on the cells of its atlas: where lightmaps, probes and directional lightmaps
/// gather from. Member functions are thread-safe once it is made.
class TexelSolution {
 public:
  struct Options {
    double noise = 0.01;            ///< of what will be gathered, relative: the cells have rays enough not to add to it
    bool front_sides_only = false;  ///< backs are black and opaque
    bool opaque_shadows = false;    ///< glass stops the shadow rays of points, spots and far lights
    std::uint64_t seed = 0;
  };

  /// Both must outlive this. Throws std::invalid_argument for faces that make_patch_mesh refuses.
  TexelSolution(const LightmapAtlas& atlas, const Texels& texels, const Options& options, const Progress& progress);

  [[nodiscard]] const TexelMap& map() const { return map_; }
  [[nodiscard]] const SamplePoints& points() const { return points_; }
  [[nodiscard]] const StraightLight& straight() const { return straight_; }
  [[nodiscard]] const TexelRays& rays() const { return rays_; }
  [[nodiscard]] const LightCells& cells() const { return *cells_; }
  /// texels_in_blocks().
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  /// Straight light of the texels, [texel * 3 + band], W/m^2. May be taken away.
  [[nodiscard]] std::vector<float>& direct() { return direct_; }
  [[nodiscard]] bool backs_are_black() const { return front_sides_only_; }
  [[nodiscard]] bool is_partial() const { return partial_; }

 private:
  RayTracer tracer_;
  TexelMap map_;
  std::unique_ptr<AtlasSpace> space_;
  StraightLight straight_;
  std::vector<std::uint32_t> order_;
  SamplePoints points_;
  TexelRays rays_;
  std::vector<float> direct_;
  std::unique_ptr<LightCells> cells_;
  bool front_sides_only_ = false;
  bool partial_ = false;
};

}  // namespace penumbra
