#include "penumbra/radiosity/form_factors/factor_matrix.h"

#include <algorithm>
#include <bit>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {
namespace {

/// One unordered pair of surfaces, packed until all rows' lengths are known.
struct PackedPair {
  std::uint32_t i, j;
  double exchange;
};

std::vector<std::uint64_t> row_offsets(const std::vector<std::vector<PackedPair>>& chunks, std::size_t rows) {
  std::vector<std::uint64_t> offsets(rows + 1, 0);
  for (const auto& chunk : chunks)
    for (const PackedPair& p : chunk) {
      ++offsets[p.i + 1];
      ++offsets[p.j + 1];
    }
  for (std::size_t i = 0; i < rows; ++i) offsets[i + 1] += offsets[i];
  return offsets;
}

/// Sorts each row by column and adds up what appears twice. Returns whether any row became shorter.
bool sort_rows(FactorMatrix& m, std::vector<std::uint64_t>& lengths) {
  lengths.assign(m.rows(), 0);
  parallel_for(m.rows(), 256, [&](std::size_t first, std::size_t last) {
    // A dense row and a bit for each column in use: cheaper than sorting thousands of entries.
    std::vector<double> dense(m.rows(), 0.0);
    std::vector<std::uint64_t> used((m.rows() + 63) / 64, 0);
    for (std::size_t i = first; i < last; ++i) {
      for (std::uint64_t k = m.offsets[i]; k < m.offsets[i + 1]; ++k) {
        dense[m.columns[k]] += m.values[k];
        used[m.columns[k] / 64] |= std::uint64_t{1} << (m.columns[k] % 64);
      }
      std::uint64_t out = m.offsets[i];
      for (std::size_t word = 0; word < used.size(); ++word) {
        for (; used[word] != 0; used[word] &= used[word] - 1) {
          const std::size_t column = 64 * word + static_cast<std::size_t>(std::countr_zero(used[word]));
          m.columns[out] = static_cast<std::uint32_t>(column);
          m.values[out++] = dense[column];
          dense[column] = 0;
        }
      }
      lengths[i] = out - m.offsets[i];
    }
  });
  for (std::size_t i = 0; i < m.rows(); ++i)
    if (lengths[i] != m.offsets[i + 1] - m.offsets[i]) return true;
  return false;
}

void close_gaps(FactorMatrix& m, const std::vector<std::uint64_t>& lengths) {
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < m.rows(); ++i) {
    const std::uint64_t begin = m.offsets[i];
    m.offsets[i] = out;
    for (std::uint64_t k = 0; k < lengths[i]; ++k, ++out) {
      m.columns[out] = m.columns[begin + k];
      m.values[out] = m.values[begin + k];
    }
  }
  m.offsets[m.rows()] = out;
  m.columns.resize(out);
  m.values.resize(out);
}

}  // namespace

double FactorMatrix::at(std::size_t i, std::size_t j) const {
  const auto row = row_columns(i);
  const auto found = std::lower_bound(row.begin(), row.end(), static_cast<std::uint32_t>(j));
  if (found == row.end() || *found != j) return 0;
  return values[offsets[i] + static_cast<std::uint64_t>(found - row.begin())];
}

double FactorMatrix::row_sum(std::size_t i) const {
  double sum = 0;
  for (double f : row_values(i)) sum += f;
  return sum;
}

FactorMatrix assemble_factor_matrix(const FormFactorMethod& method, const PatchMesh& mesh, const Progress& progress) {
  FactorMatrix m;
  for (const PatchSurface& s : mesh.surfaces) m.areas.push_back(s.area);
  m.row_errors.assign(m.rows(), 0.0);
  m.row_dropped.assign(m.rows(), 0.0);

  std::vector<std::vector<PackedPair>> chunks;
  m.partial = !visit_factors(
      method,
      [&](const FactorBlock& block) {
        if (!block.pairs.empty()) {
          auto& chunk = chunks.emplace_back();
          chunk.reserve(block.pairs.size());
          for (const PairFactor& p : block.pairs) {
            const std::uint32_t s = mesh.surface_of[p.i], t = mesh.surface_of[p.j];
            chunk.push_back({s, t, p.exchange});
            m.row_errors[s] += static_cast<double>(p.error);
            m.row_errors[t] += static_cast<double>(p.error);
          }
        }
        for (const DroppedExchange& d : block.dropped) m.row_dropped[mesh.surface_of[d.patch]] += d.exchange;
      },
      progress);

  m.offsets = row_offsets(chunks, m.rows());
  m.columns.resize(m.offsets.back());
  m.values.resize(m.offsets.back());
  std::vector<std::uint64_t> next(m.offsets.begin(), m.offsets.end() - 1);
  for (auto& chunk : chunks) {
    for (const PackedPair& p : chunk) {
      m.columns[next[p.i]] = p.j;
      m.values[next[p.i]++] = p.exchange / m.areas[p.i];
      m.columns[next[p.j]] = p.i;
      m.values[next[p.j]++] = p.exchange / m.areas[p.j];
    }
    std::vector<PackedPair>().swap(chunk);
  }
  std::vector<std::uint64_t> lengths;
  if (sort_rows(m, lengths)) close_gaps(m, lengths);
  for (std::size_t i = 0; i < m.rows(); ++i) {
    if (!(m.areas[i] > 0)) continue;
    m.row_dropped[i] /= m.areas[i];
    m.row_errors[i] = m.row_errors[i] / m.areas[i] + m.row_dropped[i];
  }
  return m;
}

}  // namespace penumbra
