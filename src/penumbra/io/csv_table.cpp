#include "penumbra/io/csv_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/io/text_cursor.h"

namespace penumbra {
namespace {

std::string trimmed(std::string_view word) {
  while (!word.empty() && (word.front() == ' ' || word.front() == '\t')) word.remove_prefix(1);
  while (!word.empty() && (word.back() == ' ' || word.back() == '\t')) word.remove_suffix(1);
  return std::string(word);
}

/// Walks through the lines of a table.
class CsvLines {
 public:
  CsvLines(const std::string& path, std::string_view text) : path_(path), text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  }

  /// The words of the next line that is not empty; none at the end.
  [[nodiscard]] bool next(CsvTable::Row& row) {
    for (;;) {
      if (text_.empty()) return false;
      row.line = line_;
      row.words.clear();
      while (!take_word(row.words)) {
      }
      if (row.words.size() > 1 || !row.words[0].empty()) return true;
    }
  }

 private:
  // Returns whether the line is over.
  bool take_word(std::vector<std::string>& words) {
    const std::size_t blank = std::min(text_.find_first_not_of(" \t"), text_.size());
    if (blank < text_.size() && text_[blank] == '"') {
      text_.remove_prefix(blank + 1);
      words.push_back(take_quoted());
    } else {
      const std::size_t size = std::min(text_.find_first_of(",\r\n"), text_.size());
      words.push_back(trimmed(text_.substr(0, size)));
      text_.remove_prefix(size);
    }
    if (text_.empty()) return true;
    const bool over = text_.front() != ',';
    if (over) {
      ++line_;
      text_.remove_prefix(text_.starts_with("\r\n") ? 2 : 1);
    } else {
      text_.remove_prefix(1);
    }
    return over;
  }

  std::string take_quoted() {
    std::string word;
    for (;;) {
      if (text_.empty()) throw FileError(path_, fmt::format("line {}", line_), "a quote is not closed");
      const char c = text_.front();
      text_.remove_prefix(1);
      if (c == '\n') ++line_;
      if (c == '"') {
        if (!text_.starts_with('"')) break;
        text_.remove_prefix(1);
      }
      word += c;
    }
    text_.remove_prefix(std::min(text_.find_first_not_of(" \t"), text_.size()));
    if (!text_.empty() && std::string_view(",\r\n").find(text_.front()) == std::string_view::npos) {
      throw FileError(path_, fmt::format("line {}", line_), "something follows a closing quote; put a comma between");
    }
    return word;
  }

  const std::string& path_;
  std::string_view text_;
  std::size_t line_ = 1;
};

}  // namespace

std::optional<std::size_t> CsvTable::column(std::string_view name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

std::size_t CsvTable::needed_column(std::string_view name) const {
  if (const auto found = column(name)) return *found;
  throw FileError(path, "",
                  fmt::format("the headline names no column {} (it has: {})", name, fmt::join(columns, ", ")));
}

double CsvTable::number(const Row& row, std::size_t column) const {
  const std::string& word = row.words[column];
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
    fail(row, fmt::format("{} should be a finite number but is {}", columns[column], in_quotes(word)));
  }
  return value;
}

std::size_t CsvTable::index(const Row& row, std::size_t column) const {
  const std::string& word = row.words[column];
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size()) {
    fail(row, fmt::format("{} should be a whole number but is {}", columns[column], in_quotes(word)));
  }
  return value;
}

void CsvTable::fail(const Row& row, std::string_view sentence) const {
  throw FileError(path, fmt::format("line {}", row.line), sentence);
}

CsvTable read_csv_table(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  CsvTable table;
  table.path = path.string();
  CsvLines lines(table.path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  CsvTable::Row row;
  while (lines.next(row)) {
    if (table.columns.empty()) {
      if (row.words[0].starts_with('#')) {
        table.comments.push_back(row.words[0]);
      } else {
        table.columns = row.words;
      }
    } else if (row.words.size() != table.columns.size()) {
      table.fail(row, fmt::format("has {} words, but the headline has {}", row.words.size(), table.columns.size()));
    } else {
      table.rows.push_back(row);
    }
  }
  if (table.columns.empty()) throw FileError(table.path, "", "holds no table: its first line should name the columns");
  return table;
}

std::string csv_word(std::string_view word) {
  if (word.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(word);
  std::string out = "\"";
  for (const char c : word) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

}  // namespace penumbra
