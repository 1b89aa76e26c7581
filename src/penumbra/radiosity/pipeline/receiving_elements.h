#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/meshing/adaptive_cells.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// What receives: the pieces of patches as they are cut at present, and what has arrived at each.
///
/// Cuts keep what has arrived: the pieces of an element share out what it had received, in proportion to what the
/// patches' light brings to each, so that no power appears or is lost.
class ReceivingElements {
 public:
  struct Options {
    bool front_sides_only = false;  ///< backs are black and opaque
    FormFactorOptions factors;
    std::uint64_t seed = 0;
  };

  /// Starts with the elements of `cells`, dark but for the lights that are no elements. Scene and patches must outlive
  /// this. @param occluders what stands in the way, made from the faces.
  ReceivingElements(const Scene& scene, const PatchMesh& patches, std::shared_ptr<const OccluderPolygons> occluders,
                    const AdaptiveCells& cells, const Options& options, const Progress& progress);

  /// Follows cells that were cut since their last mark(). @param sent what each patch has sent until now, W/m^2,
  /// [patch * 3 + band].
  void follow(const AdaptiveCells& cells, std::span<const double> sent);
  /// Computes the light of what is no element anew, for all elements together.
  void light_again();
  /// Replaces what has arrived by what the elements themselves send each other, not the patches' means: H_e = sum_c
  /// F_ec S_c, each pair once, in O(elements) memory. Returns false, and leaves all as it is, when asked to stop.
  /// @param sent by each element, W/m^2, [element * 3 + band].
  [[nodiscard]] bool gather(std::span<const double> sent, const Progress& progress);

  [[nodiscard]] const PatchMesh& mesh() const { return mesh_; }
  [[nodiscard]] const RadiosityProblem& problem() const { return problem_; }
  [[nodiscard]] std::uint32_t patch_of(std::size_t element) const { return parent_[element]; }
  [[nodiscard]] std::size_t size() const { return parent_.size(); }

  /// Irradiance that patches have sent, W/m^2, [element * 3 + band].
  [[nodiscard]] const std::vector<double>& received() const { return received_; }
  /// Adds what a patch sends. @param exchange A_e F_ep, m^2; @param radiosity of the patch, three bands, W/m^2.
  /// Returns the power, W, summed over bands.
  double receive(std::uint32_t element, double exchange, std::span<const double> radiosity);
  /// Cells that received more than `enough` (W/m^2, largest band) since the last forget_arrivals(), ascending.
  [[nodiscard]] std::vector<std::uint32_t> brightened_cells(double enough) const;
  void forget_arrivals() { arrived_.assign(arrived_.size(), 0.0); }

  /// From everywhere, W/m^2, [element * 3 + band].
  [[nodiscard]] std::vector<double> irradiance() const;
  [[nodiscard]] std::vector<double> radiosity() const;
  /// Power received from patches, W, summed over bands.
  [[nodiscard]] double received_power() const;

 private:
  struct Fresh;  // elements that were not there before, and what they came from
  void paint_and_light(const Fresh& fresh);
  void share_out(const Fresh& fresh, std::span<const double> old_power, std::span<const double> sent);
  void gather_from_patches(const Fresh& fresh, std::span<const double> sent);

  const Scene& scene_;
  const PatchMesh& patches_;
  std::shared_ptr<const OccluderPolygons> occluders_;
  Options options_;
  Progress progress_;
  PatchMesh mesh_;
  RadiosityProblem problem_;
  std::vector<std::uint32_t> parent_, cell_of_;
  std::vector<double> received_, arrived_;
};

}  // namespace penumbra
