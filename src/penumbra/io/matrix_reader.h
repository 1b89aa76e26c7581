#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace penumbra {

/// A square matrix of factors as it stood in a file, in compressed sparse rows with ascending columns.
struct MatrixFile {
  std::vector<std::uint64_t> offsets{0};  ///< row i is columns/values [offsets[i], offsets[i + 1])
  std::vector<std::uint32_t> columns;
  std::vector<double> values;
  std::vector<double> areas;       ///< m^2, one a row; empty when the file says none
  std::vector<std::string> names;  ///< UTF-8, one a row; empty when the file says none
  bool partial = false;            ///< the computation of the factors was stopped: what is missing reads as 0

  [[nodiscard]] std::size_t rows() const { return offsets.size() - 1; }
};

/// By the extension of `path`:
/// - `.npz`: what MatrixWriter and `scipy.sparse.save_npz` write, compressed or not: formats csr, csc and coo.
/// - `.mtx`: Matrix Market, coordinate or array, real or integer, general or symmetric; areas and names from
///   MatrixWriter's comments.
/// - `.csv`: lines `i,j,factor` counted from 0, with `from`, `to` and `area` of row i where they stand.
/// Entries that appear twice add up. Throws FileError when the file is missing, damaged, no square matrix, has an index
/// outside it or a value that is negative or not finite.
[[nodiscard]] MatrixFile read_matrix(const std::filesystem::path& path);

}  // namespace penumbra
