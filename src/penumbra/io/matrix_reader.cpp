#include "penumbra/io/matrix_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/io/csv_table.h"
#include "penumbra/io/npy_array.h"
#include "penumbra/io/text_cursor.h"
#include "penumbra/io/zip_reader.h"

namespace penumbra {
namespace {

constexpr std::int64_t most_rows = std::numeric_limits<std::uint32_t>::max() - 1;

struct Entry {
  std::uint32_t row, column;
  double value;
};

/// Puts entries in any order into rows.
void fill_rows(MatrixFile& matrix, std::size_t rows, std::vector<Entry> entries) {
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.row != b.row ? a.row < b.row : a.column < b.column; });
  matrix.offsets.assign(rows + 1, 0);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Entry& e = entries[k];
    if (k > 0 && entries[k - 1].row == e.row && entries[k - 1].column == e.column) {
      matrix.values.back() += e.value;
      continue;
    }
    matrix.columns.push_back(e.column);
    matrix.values.push_back(e.value);
    matrix.offsets[e.row + 1] = matrix.columns.size();
  }
  for (std::size_t i = 0; i < rows; ++i) matrix.offsets[i + 1] = std::max(matrix.offsets[i + 1], matrix.offsets[i]);
}

void check_factor(double value, const std::string& path, const std::string& place) {
  if (std::isfinite(value) && value >= 0) return;
  throw FileError(path, place, fmt::format("a factor is {}; factors are finite and not negative", value));
}

// Rows that see nothing are rare: a matrix of many more rows than its file has bytes is a damaged one.
void check_size(std::int64_t rows, std::size_t bytes, const std::string& path, const std::string& place) {
  if (static_cast<std::size_t>(rows) <= bytes + 1024) return;
  throw FileError(path, place, fmt::format("the matrix has {} rows, far more than entries; the file is damaged", rows));
}

// SciPy's indices may have 32 bits.
std::vector<std::int64_t> integers_from(const NpyArray& array) {
  if (array.type == "|b1") return {array.bytes.begin(), array.bytes.end()};
  if (array.type != "<i4") return integers_of(array);
  std::vector<std::int32_t> values(array.size());
  if (!values.empty()) std::memcpy(values.data(), array.bytes.data(), 4 * values.size());
  return {values.begin(), values.end()};
}

std::vector<std::string> texts_from(const NpyArray& array) {
  if (!array.type.starts_with("|S")) return texts_of(array);
  return {std::string(array.bytes)};
}

/// The arrays of an .npz.
class NpzMatrix {
 public:
  explicit NpzMatrix(const std::filesystem::path& path) : zip_(path) {}

  [[nodiscard]] MatrixFile read() const {
    const std::vector<std::string> format = take("format", texts_from);
    const std::vector<std::int64_t> shape = integers("shape");
    if (shape.size() != 2 || shape[0] != shape[1] || shape[0] < 0 || shape[0] > most_rows) {
      throw FileError(zip_.path(), "shape.npy", "the matrix is not square; factors are from all surfaces to all");
    }
    const auto rows = static_cast<std::size_t>(shape[0]);
    const std::string kind = format.size() == 1 ? format[0] : "";
    MatrixFile matrix;
    if (kind == "coo") {
      check_size(shape[0], numbers("data").size(), zip_.path(), "shape.npy");
      fill_rows(matrix, rows, entries(integers("row"), integers("col"), rows));
    } else if (kind == "csr") {
      fill_rows(matrix, rows, entries(spread("indptr", rows), integers("indices"), rows));
    } else if (kind == "csc") {
      fill_rows(matrix, rows, entries(integers("indices"), spread("indptr", rows), rows));
    } else {
      throw FileError(zip_.path(), "format.npy", "the matrix is neither csr, csc nor coo; save it after .tocsr()");
    }
    read_description(matrix);
    return matrix;
  }

 private:
  template <class Values>
  [[nodiscard]] Values take(const std::string& name, Values (*convert)(const NpyArray&)) const {
    const std::vector<std::byte> bytes = zip_.read(name + ".npy");
    try {
      return convert(read_npy({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
    } catch (const FileError&) {
      throw;
    } catch (const std::runtime_error& e) {
      throw FileError(zip_.path(), name + ".npy", e.what());
    }
  }
  [[nodiscard]] std::vector<std::int64_t> integers(const std::string& name) const { return take(name, integers_from); }
  [[nodiscard]] std::vector<double> numbers(const std::string& name) const { return take(name, reals_of); }

  // The row (or column) of each entry from where each row (or column) begins.
  [[nodiscard]] std::vector<std::int64_t> spread(const std::string& name, std::size_t rows) const {
    const std::vector<std::int64_t> begins = integers(name);
    const auto count = static_cast<std::int64_t>(numbers("data").size());
    const bool sound = begins.size() == rows + 1 && begins.front() == 0 && begins.back() == count &&
                       std::is_sorted(begins.begin(), begins.end());
    if (!sound) throw FileError(zip_.path(), name + ".npy", "does not fit the other arrays; the file is damaged");
    std::vector<std::int64_t> line;
    line.reserve(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < rows; ++i) {
      line.insert(line.end(), static_cast<std::size_t>(begins[i + 1] - begins[i]), static_cast<std::int64_t>(i));
    }
    return line;
  }

  [[nodiscard]] std::vector<Entry> entries(const std::vector<std::int64_t>& row,
                                           const std::vector<std::int64_t>& column, std::size_t rows) const {
    const std::vector<double> data = numbers("data");
    if (row.size() != data.size() || column.size() != data.size()) {
      throw FileError(zip_.path(), "data.npy", "does not fit the indices; the file is damaged");
    }
    std::vector<Entry> out;
    out.reserve(data.size());
    const auto limit = static_cast<std::int64_t>(rows);
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (row[k] < 0 || row[k] >= limit || column[k] < 0 || column[k] >= limit) {
        throw FileError(zip_.path(), "indices.npy", fmt::format("entry {} lies outside the matrix", k));
      }
      check_factor(data[k], zip_.path(), fmt::format("data.npy, entry {}", k));
      out.push_back({static_cast<std::uint32_t>(row[k]), static_cast<std::uint32_t>(column[k]), data[k]});
    }
    return out;
  }

  void read_description(MatrixFile& matrix) const {
    if (zip_.has("area.npy")) matrix.areas = numbers("area");
    if (zip_.has("name.npy")) matrix.names = take("name", texts_from);
    if (!matrix.areas.empty() && matrix.areas.size() != matrix.rows()) {
      throw FileError(zip_.path(), "area.npy", "should hold one area a row");
    }
    if (!matrix.names.empty() && matrix.names.size() != matrix.rows()) {
      throw FileError(zip_.path(), "name.npy", "should hold one name a row");
    }
    if (!zip_.has("partial.npy")) return;
    const std::vector<std::int64_t> partial = integers("partial");
    matrix.partial = !partial.empty() && partial[0] != 0;
  }

  ZipReader zip_;
};

/// What MatrixWriter says in comments: "% 3 1.5 the name" after "% row area_m2 name".
void read_market_comment(std::string_view line, MatrixFile& matrix, bool& described) {
  if (line.starts_with("% partial:")) matrix.partial = true;
  if (line.starts_with("% row area_m2 name")) {
    described = true;
    return;
  }
  if (!described || !line.starts_with("% ")) return;
  line.remove_prefix(2);
  std::size_t row = 0;
  double area = 0;
  const char* const last = line.data() + line.size();
  const auto index = std::from_chars(line.data(), last, row);
  if (index.ec != std::errc{} || row != matrix.areas.size() + 1 || index.ptr == last) return;
  const auto size = std::from_chars(index.ptr + 1, last, area);
  if (size.ec != std::errc{}) return;
  matrix.areas.push_back(area);
  matrix.names.emplace_back(size.ptr == last ? size.ptr : size.ptr + 1, last);
}

MatrixFile read_market(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  TextCursor cursor(path.string(), text);
  std::string banner(cursor.rest_of_line());
  std::transform(banner.begin(), banner.end(), banner.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool coordinates = banner.starts_with("%%matrixmarket matrix coordinate");
  if (!coordinates && !banner.starts_with("%%matrixmarket matrix array")) {
    cursor.fail("should begin with %%MatrixMarket matrix coordinate or array");
  }
  const bool symmetric = banner.ends_with(" symmetric");
  if ((!symmetric && !banner.ends_with(" general")) || banner.find("complex") != std::string::npos ||
      banner.find("pattern") != std::string::npos) {
    cursor.fail("should hold a real matrix, general or symmetric");
  }
  MatrixFile matrix;
  bool described = false;
  cursor.skip_line();
  while (cursor.offset() < text.size() && text[cursor.offset()] == '%') {
    read_market_comment(cursor.rest_of_line(), matrix, described);
    cursor.skip_line();
  }
  const auto count = [&](std::string_view what, std::int64_t most) {
    return cursor.integer(cursor.word(), what, 0, most);
  };
  const std::int64_t rows = count("the number of rows", most_rows), columns = count("the number of columns", most_rows);
  if (rows != columns) cursor.fail("the matrix is not square; factors are from all surfaces to all");
  check_size(rows, text.size(), path.string(), fmt::format("line {}", cursor.line()));
  // An entry takes two bytes at least: no more can follow.
  const auto most_entries = static_cast<std::int64_t>(text.size() / 2 + 1);
  const std::int64_t listed = coordinates ? count("the number of entries", most_entries) : 0;
  if (!coordinates && rows > 0 && (symmetric ? rows / 2 : rows) > most_entries / rows)
    cursor.fail("the file is cut short");
  std::vector<Entry> entries;
  const auto take = [&](std::int64_t i, std::int64_t j) {
    const double value = cursor.number(cursor.word(), "a factor");
    check_factor(value, path.string(), fmt::format("line {}", cursor.line()));
    entries.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), value});
    if (symmetric && i != j) entries.push_back({entries.back().column, entries.back().row, value});
  };
  for (std::int64_t k = 0; k < listed; ++k) {
    const std::int64_t i = cursor.integer(cursor.word(), "a row", 1, rows);
    take(i - 1, cursor.integer(cursor.word(), "a column", 1, rows) - 1);
  }
  if (!coordinates) {
    for (std::int64_t j = 0; j < rows; ++j)
      for (std::int64_t i = symmetric ? j : 0; i < rows; ++i) take(i, j);
  }
  fill_rows(matrix, static_cast<std::size_t>(rows), std::move(entries));
  if (matrix.areas.size() != matrix.rows()) {
    matrix.areas.clear();
    matrix.names.clear();
  }
  return matrix;
}

MatrixFile read_csv(const std::filesystem::path& path) {
  const CsvTable table = read_csv_table(path);
  const std::size_t i = table.needed_column("i"), j = table.needed_column("j"), factor = table.needed_column("factor");
  const auto from = table.column("from"), to = table.column("to"), area = table.column("area");
  MatrixFile matrix;
  for (const std::string& comment : table.comments) matrix.partial = matrix.partial || comment.starts_with("# partial");
  std::vector<Entry> entries;
  std::size_t rows = 0;
  for (const CsvTable::Row& row : table.rows) {
    const std::size_t a = table.index(row, i), b = table.index(row, j);
    // Every surface sees something or is seen, so that there are no more than twice as many as lines.
    if (std::max(a, b) >= 2 * table.rows.size() + 2)
      table.fail(row, "an index is far beyond the number of lines; indices count from 0");
    const double value = table.number(row, factor);
    check_factor(value, table.path, fmt::format("line {}", row.line));
    entries.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), value});
    rows = std::max({rows, a + 1, b + 1});
  }
  if (from && to) matrix.names.resize(rows);
  if (area) matrix.areas.assign(rows, 0.0);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (area) matrix.areas[entries[k].row] = table.number(table.rows[k], *area);
    if (!from || !to) continue;
    matrix.names[entries[k].row] = table.rows[k].words[*from];
    matrix.names[entries[k].column] = table.rows[k].words[*to];
  }
  if (area && std::find(matrix.areas.begin(), matrix.areas.end(), 0.0) != matrix.areas.end()) matrix.areas.clear();
  fill_rows(matrix, rows, std::move(entries));
  return matrix;
}

}  // namespace

MatrixFile read_matrix(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".npz") return NpzMatrix(path).read();
  if (extension == ".mtx") return read_market(path);
  if (extension == ".csv") return read_csv(path);
  throw FileError(path.string(), "", "factors are read from .npz, .mtx or .csv; the name should end in one of them");
}

}  // namespace penumbra
