#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// Light that reaches elements by way of mirrors and glass, as a sparse matrix beside the form factors: the part of the
/// extended form factors (Wallace, Cohen & Greenberg 1987; Sillion & Puech 1989) that the plain ones leave out.
///
/// Entry X_ij is the irradiance of element i for each unit of radiosity of j that takes at least one turn at a mirror
/// or passes glass on its way, per band, since mirrors have colours: H_i += sum_j X_ij B_j. Not symmetric: it is
/// sampled.
struct SpecularTransport {
  static constexpr std::size_t bands = 3;

  std::vector<std::uint64_t> offsets{0};  ///< row i is entries [offsets[i], offsets[i + 1]), ascending columns
  std::vector<std::uint32_t> columns;
  std::vector<float> values;  ///< [entry * 3 + band]
  /// Half the difference between the two independent halves of the rays that were averaged, [entry * 3 + band].
  std::vector<float> deviations;
  /// The share of an element's radiosity that leaves the scene by way of mirrors and glass, [element * 3 + band].
  std::vector<float> leaving;

  [[nodiscard]] std::size_t rows() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> row_columns(std::size_t i) const {
    return std::span(columns).subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
  /// sum_j X_ij, per band.
  [[nodiscard]] Vec3d row_sum(std::size_t i) const;

  /// Adds sum_j X_ij B_j for the rows [first, last) to `irradiance`. @param radiosity of all elements, W/m^2.
  /// @param irradiance [(i - first) * 3 + band], W/m^2.
  void gather(std::size_t first, std::size_t last, std::span<const double> radiosity,
              std::span<double> irradiance) const;
  /// Standard error of what `gather` adds, [element * 3 + band], W/m^2: by the two halves, so itself an estimate (one
  /// degree of freedom an element); its mean over many elements is what to look at.
  [[nodiscard]] std::vector<double> standard_errors(std::span<const double> radiosity) const;
};

/// The same matrix by columns: what each element sends. Entry order is by ascending row.
[[nodiscard]] SpecularTransport transposed(const SpecularTransport& transport);

}  // namespace penumbra
