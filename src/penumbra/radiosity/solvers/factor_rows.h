#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// One row of the factor matrix, by ascending column.
struct FactorRow {
  std::vector<std::uint32_t> columns;
  std::vector<double> factors;  ///< F_sj from the row's element s to j
};

/// Where a shooter gets its factors from: one row at a time, so that nobody need hold the matrix.
///
/// Thread-safe; a row is the same bits each time it is asked for, on whichever thread or rank.
class FactorRowSource {
 public:
  virtual ~FactorRowSource() = default;
  /// The number of elements.
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Replaces `row` by that of `element`, whose memory it may reuse. @pre element < size()
  virtual void read(std::size_t element, FactorRow& row) const = 0;
};

/// The rows of a matrix, which must outlive it.
class MatrixRows final : public FactorRowSource {
 public:
  explicit MatrixRows(const FactorMatrix& matrix) : matrix_(matrix) {}
  [[nodiscard]] std::size_t size() const override { return matrix_.rows(); }
  void read(std::size_t element, FactorRow& row) const override;

 private:
  const FactorMatrix& matrix_;
};

/// Rows computed when they are asked for, in O(n) memory: a hemicube, rays or points at the shooter alone. Method and
/// mesh must outlive it. An element is a surface of the mesh.
class MethodRows final : public FactorRowSource {
 public:
  /// Throws std::invalid_argument when the method computes no rows.
  MethodRows(const FormFactorMethod& method, const PatchMesh& mesh);
  [[nodiscard]] std::size_t size() const override { return mesh_.surface_count(); }
  void read(std::size_t element, FactorRow& row) const override;

 private:
  const FormFactorMethod& method_;
  const PatchMesh& mesh_;
  std::vector<std::uint32_t> first_patch_;  ///< surface s has the radiating patches [first_patch_[s], [s + 1])
};

/// Rows of another source, which must outlive it; those that sum to more than 1 are scaled to 1: nothing sends out more
/// light than it has.
class LimitedRows final : public FactorRowSource {
 public:
  explicit LimitedRows(const FactorRowSource& source) : source_(source) {}
  [[nodiscard]] std::size_t size() const override { return source_.size(); }
  void read(std::size_t element, FactorRow& row) const override;

 private:
  const FactorRowSource& source_;
};

/// Rows of another source, which must outlive it, kept once they were read as long as there is room: a shooter shoots
/// several times.
class KeptRows final : public FactorRowSource {
 public:
  /// @param most_factors kept altogether, 12 bytes each.
  explicit KeptRows(const FactorRowSource& source, std::size_t most_factors = 4000000)
      : source_(source), room_(most_factors) {}
  [[nodiscard]] std::size_t size() const override { return source_.size(); }
  void read(std::size_t element, FactorRow& row) const override;

 private:
  const FactorRowSource& source_;
  mutable std::mutex mutex_;
  mutable std::unordered_map<std::size_t, FactorRow> kept_;
  mutable std::size_t room_;
};

}  // namespace penumbra
