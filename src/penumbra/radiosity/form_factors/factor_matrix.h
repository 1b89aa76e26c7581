#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"

namespace penumbra {

/// All form factors of a mesh as compressed sparse rows, one a surface: F_ij, the share (dimensionless, 0..1) of the
/// power leaving surface i that arrives at surface j. Columns ascend within a row. F_ii is stored only where a surface
/// has several patches that see each other.
struct FactorMatrix {
  std::vector<double> areas;              ///< m^2, per row
  std::vector<std::uint64_t> offsets{0};  ///< row i is columns/values [offsets[i], offsets[i + 1])
  std::vector<std::uint32_t> columns;
  std::vector<double> values;
  std::vector<double> row_errors;  ///< per row: estimate of the sum over j of |error of F_ij|, dropped factors included
  std::vector<double> row_dropped;  ///< per row: the sum of the factors left out, contained in row_errors
  bool partial = false;             ///< stopped before all pairs were computed

  [[nodiscard]] std::size_t rows() const { return areas.size(); }
  [[nodiscard]] std::span<const std::uint32_t> row_columns(std::size_t i) const {
    return std::span(columns).subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
  [[nodiscard]] std::span<const double> row_values(std::size_t i) const {
    return std::span(values).subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
  /// F_ij, 0 where nothing is stored.
  [[nodiscard]] double at(std::size_t i, std::size_t j) const;
  [[nodiscard]] double row_sum(std::size_t i) const;
};

/// Assembles the blocks of `method`, made for `mesh`; a surface's factors are the area-weighted means of its patches'.
/// Peak memory is about 24 bytes a stored factor.
[[nodiscard]] FactorMatrix assemble_factor_matrix(const FormFactorMethod& method, const PatchMesh& mesh,
                                                  const Progress& progress = {});

}  // namespace penumbra
