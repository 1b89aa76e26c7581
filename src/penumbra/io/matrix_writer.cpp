#include "penumbra/io/matrix_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <string_view>

#include "penumbra/file/file_error.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/csv_table.h"
#include "penumbra/io/npy_array.h"
#include "penumbra/io/spool_file.h"
#include "penumbra/io/zip_writer.h"

namespace penumbra {
namespace {

template <class T>
std::string_view raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

class NpzWriter final : public MatrixWriter {
 public:
  explicit NpzWriter(const std::filesystem::path& path) : out_(path), data_(path), indices_(path) {}

  void add_row(std::span<const std::uint32_t> columns, std::span<const double> values) override {
    assert(columns.size() == values.size());
    indices_.write(std::as_bytes(columns));
    data_.write(std::as_bytes(values));
    offsets_.push_back(offsets_.back() + static_cast<std::int64_t>(columns.size()));
  }

  void finish(const MatrixDescription& description) override {
    const std::size_t rows = description.areas.size();
    assert(offsets_.size() == rows + 1);
    const std::string entries = fmt::format("({},)", offsets_.back());
    const std::vector<std::int64_t> shape{static_cast<std::int64_t>(rows), static_cast<std::int64_t>(rows)};
    ZipWriter zip(out_);
    zip.add("indices.npy", npy_header("<i4", entries), indices_);
    zip.add("indptr.npy", npy_header("<i8", fmt::format("({},)", rows + 1)) + std::string(raw(offsets_)));
    zip.add("format.npy", npy_header("|S3", "()") + "csr");
    zip.add("shape.npy", npy_header("<i8", "(2,)") + std::string(raw(shape)));
    zip.add("data.npy", npy_header("<f8", entries), data_);
    zip.add("area.npy", npy_array(description.areas));
    zip.add("name.npy", npy_array(description.names));
    zip.add("partial.npy", npy_truth(description.partial));
    zip.finish();
    out_.commit();
  }

 private:
  OutputFile out_;
  SpoolFile data_, indices_;
  std::vector<std::int64_t> offsets_{0};
};

// Text that waits until the number of entries or the names are known.
class MatrixMarketWriter final : public MatrixWriter {
 public:
  explicit MatrixMarketWriter(const std::filesystem::path& path) : out_(path), entries_(path) {}

  void add_row(std::span<const std::uint32_t> columns, std::span<const double> values) override {
    ++row_;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::string line = fmt::format("{} {} {}\n", row_, columns[k] + 1, values[k]);
      entries_.write(std::as_bytes(std::span(line)));
    }
    count_ += columns.size();
  }

  void finish(const MatrixDescription& description) override {
    std::string head =
        "%%MatrixMarket matrix coordinate real general\n% form factors F_ij: the share of what leaves i "
        "that arrives at j\n";
    if (description.partial) head += "% partial: the computation was stopped, missing entries read as 0\n";
    head += "% row area_m2 name\n";
    for (std::size_t i = 0; i < description.areas.size(); ++i) {
      std::string name = description.names[i];
      std::replace_if(
          name.begin(), name.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
      head += fmt::format("% {} {} {}\n", i + 1, description.areas[i], name);
    }
    head += fmt::format("{0} {0} {1}\n", description.areas.size(), count_);
    out_.write(head);
    entries_.copy_to(out_);
    out_.commit();
  }

 private:
  OutputFile out_;
  SpoolFile entries_;
  std::uint64_t row_ = 0;
  std::uint64_t count_ = 0;
};

class CsvWriter final : public MatrixWriter {
 public:
  explicit CsvWriter(const std::filesystem::path& path) : out_(path), entries_(path) {}

  void add_row(std::span<const std::uint32_t> columns, std::span<const double> values) override {
    entries_.write_value(static_cast<std::uint64_t>(columns.size()));
    entries_.write(std::as_bytes(columns));
    entries_.write(std::as_bytes(values));
  }

  void finish(const MatrixDescription& description) override {
    std::vector<std::string> names;
    for (const std::string& name : description.names) names.push_back(csv_word(name));
    out_.write(description.partial ? "# partial: the computation was stopped, missing entries read as 0\n" : "");
    out_.write("i,j,from,to,area,factor\n");
    std::uint64_t at = 0;
    std::vector<std::uint32_t> columns;
    std::vector<double> values;
    for (std::size_t i = 0; i < description.areas.size(); ++i) {
      read_row(at, columns, values);
      std::string lines;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        lines += fmt::format("{},{},{},{},{},{}\n", i, columns[k], names[i], names[columns[k]], description.areas[i],
                             values[k]);
      }
      out_.write(lines);
    }
    out_.commit();
  }

 private:
  void read_row(std::uint64_t& at, std::vector<std::uint32_t>& columns, std::vector<double>& values) {
    std::uint64_t count = 0;
    const auto take = [&](std::span<std::byte> bytes) {
      entries_.read(at, bytes);
      at += bytes.size();
    };
    take(std::as_writable_bytes(std::span(&count, 1)));
    columns.resize(count);
    values.resize(count);
    take(std::as_writable_bytes(std::span(columns)));
    take(std::as_writable_bytes(std::span(values)));
  }

  OutputFile out_;
  SpoolFile entries_;
};

}  // namespace

std::unique_ptr<MatrixWriter> make_matrix_writer(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".npz") return std::make_unique<NpzWriter>(path);
  if (extension == ".mtx") return std::make_unique<MatrixMarketWriter>(path);
  if (extension == ".csv") return std::make_unique<CsvWriter>(path);
  throw FileError(path.string(), "", "a matrix is written as .npz, .mtx or .csv; end the name in one of them");
}

}  // namespace penumbra
