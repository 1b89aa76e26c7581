#include "penumbra/radiosity/solvers/factor_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace penumbra {

void MatrixRows::read(std::size_t element, FactorRow& row) const {
  const auto columns = matrix_.row_columns(element);
  const auto values = matrix_.row_values(element);
  row.columns.assign(columns.begin(), columns.end());
  row.factors.assign(values.begin(), values.end());
}

MethodRows::MethodRows(const FormFactorMethod& method, const PatchMesh& mesh) : method_(method), mesh_(mesh) {
  if (!method.computes_rows()) {
    throw std::invalid_argument(
        fmt::format("the form factor method {} computes no single rows; use hemicube or ray-cast, or a solver that "
                    "keeps the matrix",
                    method.name()));
  }
  first_patch_.assign(mesh.surface_count() + 1, 0);
  for (std::size_t p = 0; p < mesh.radiating_count; ++p) ++first_patch_[mesh.surface_of[p] + 1];
  for (std::size_t s = 0; s < mesh.surface_count(); ++s) first_patch_[s + 1] += first_patch_[s];
}

void MethodRows::read(std::size_t element, FactorRow& row) const {
  row.columns.clear();
  row.factors.clear();
  const auto take = [&](const PatchRow& sent) {
    for (std::size_t k = 0; k < sent.patches.size(); ++k) {
      const std::uint32_t column = mesh_.surface_of[sent.patches[k]];
      const double factor = sent.exchanges[k] / mesh_.surfaces[element].area;
      if (!row.columns.empty() && row.columns.back() == column) {
        row.factors.back() += factor;  // patches are ordered by surface
      } else {
        row.columns.push_back(column);
        row.factors.push_back(factor);
      }
    }
  };
  const std::uint32_t first = first_patch_[element], last = first_patch_[element + 1];
  if (last - first == 1) return take(method_.row(first));

  // Several patches radiate as one.
  std::vector<std::pair<std::uint32_t, double>> all;
  for (std::uint32_t p = first; p < last; ++p) {
    const PatchRow sent = method_.row(p);
    for (std::size_t k = 0; k < sent.patches.size(); ++k) all.emplace_back(sent.patches[k], sent.exchanges[k]);
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  PatchRow merged;
  for (const auto& [patch, exchange] : all) {
    merged.patches.push_back(patch);
    merged.exchanges.push_back(exchange);
  }
  take(merged);
}

void LimitedRows::read(std::size_t element, FactorRow& row) const {
  source_.read(element, row);
  const double sum = std::accumulate(row.factors.begin(), row.factors.end(), 0.0);
  if (sum <= 1) return;
  for (double& factor : row.factors) factor /= sum;
}

void KeptRows::read(std::size_t element, FactorRow& row) const {
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = kept_.find(element); known != kept_.end()) {
      row = known->second;
      return;
    }
  }
  source_.read(element, row);
  const std::lock_guard lock(mutex_);
  if (row.columns.size() > room_ || kept_.contains(element)) return;
  room_ -= row.columns.size();
  kept_.emplace(element, row);
}

}  // namespace penumbra
