#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace penumbra {

/// What a square matrix of factors is about.
struct MatrixDescription {
  std::vector<double> areas;       ///< m^2, one a row
  std::vector<std::string> names;  ///< UTF-8, one a row
  bool partial = false;            ///< the computation was stopped: what is missing reads as 0
};

/// Writes a sparse matrix row by row without holding it in memory; the file has its name when it is whole.
class MatrixWriter {
 public:
  virtual ~MatrixWriter() = default;
  /// The next row. @pre columns ascend.
  virtual void add_row(std::span<const std::uint32_t> columns, std::span<const double> values) = 0;
  /// Writes the file under its name. Throws std::system_error when the device refuses.
  /// @pre as many rows were added as the description names.
  virtual void finish(const MatrixDescription& description) = 0;
};

/// By the extension of `path`:
/// - `.npz`: compressed sparse rows as `scipy.sparse.load_npz` reads them (`data` float64, `indices`, `indptr`,
/// `shape`,
///   `format`), with `area` (m^2), `name` (fixed-width Unicode) and `partial` (bool) added; nothing is pickled.
/// - `.mtx`: Matrix Market coordinates, counted from 1; areas and names are comments.
/// - `.csv`: a line `i,j,from,to,area,factor` an entry, counted from 0.
/// Throws FileError when the file cannot be created or the extension is another one.
[[nodiscard]] std::unique_ptr<MatrixWriter> make_matrix_writer(const std::filesystem::path& path);

}  // namespace penumbra
