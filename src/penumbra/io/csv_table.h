#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// A table of text with a headline (RFC 4180: quotes around words that hold commas, quotes or line ends). Lines that
/// begin with # may stand before the headline; empty lines are passed over; blanks around bare words are trimmed.
struct CsvTable {
  std::string path;
  std::vector<std::string> comments;  ///< the lines before the headline that begin with #
  std::vector<std::string> columns;
  struct Row {
    std::size_t line = 0;  ///< in the file, from 1
    std::vector<std::string> words;
  };
  std::vector<Row> rows;  ///< each as long as the headline

  /// The index of a column, or nothing.
  [[nodiscard]] std::optional<std::size_t> column(std::string_view name) const;
  /// The index of a column. Throws FileError that lists the columns there are.
  [[nodiscard]] std::size_t needed_column(std::string_view name) const;
  /// A word as a finite number. Throws FileError with line and column.
  [[nodiscard]] double number(const Row& row, std::size_t column) const;
  /// A word as a whole number of 0 or more. Throws FileError with line and column.
  [[nodiscard]] std::size_t index(const Row& row, std::size_t column) const;
  /// Throws FileError at the row's line.
  [[noreturn]] void fail(const Row& row, std::string_view sentence) const;
};

/// Throws FileError when the file cannot be read, has no headline, or a row has another number of words than it.
[[nodiscard]] CsvTable read_csv_table(const std::filesystem::path& path);

/// A word as it is written in such a table.
[[nodiscard]] std::string csv_word(std::string_view word);

}  // namespace penumbra
