#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// The flagship: for each pair of patches the cheapest rule that meets the tolerance.
///
/// Patches are grouped in clusters of sixteen, coplanar neighbours are merged into occluder polygons, and for each pair
/// of clusters the occluders that cross its shaft are listed once. A pair of patches is then visible, hidden or partly
/// hidden, decided conservatively by corners. Visible pairs take the kernel at 4 x 4 points where its error is small,
/// the exact point-to-polygon factor at Gauss points nearer, and the closed form (`exchange_area`) where they touch;
/// partly hidden ones integrate the exact visible fragments, cutting along shadow lines (see ObstructedExchange).
///
/// Reads FormFactorOptions::tolerance. The share of it that a pair may use is in proportion to the area of its partner
/// and to its own exchange, so that a row's errors add up to no more than the tolerance.
class AutoFormFactors : public FormFactorMethod {
 public:
  struct Settings {
    bool merge_occluders = true;   ///< off: every patch hides for itself (for measurements)
    std::size_t max_cells = 4096;  ///< pieces that one partly hidden pair may be cut into
    /// What hides, made beforehand from coarser patches of the same surfaces; none: the mesh's own patches.
    std::shared_ptr<const OccluderPolygons> occluders{};
    std::size_t surveyed_clusters = 24;  ///< whose rows are looked at to share out the tolerance; at least 1
  };

  AutoFormFactors(const PatchMesh& mesh, const FormFactorOptions& options);
  AutoFormFactors(const PatchMesh& mesh, const FormFactorOptions& options, const Settings& settings);
  ~AutoFormFactors() override;

  [[nodiscard]] std::string_view name() const override { return "auto"; }
  [[nodiscard]] std::size_t block_count() const override;
  [[nodiscard]] FactorBlock block(std::size_t index) const override;
  /// The factors of the blocks, up to the tolerance.
  [[nodiscard]] bool computes_rows() const override { return true; }
  [[nodiscard]] PatchRow row(std::uint32_t patch) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace penumbra
