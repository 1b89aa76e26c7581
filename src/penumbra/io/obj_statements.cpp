#include "penumbra/io/obj_statements.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "penumbra/file/file_error.h"
#include "penumbra/io/text_cursor.h"

namespace penumbra {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || c == '\0'; }

}  // namespace

ObjStatements::ObjStatements(std::string path, std::string_view text)
    : path_(std::move(path)), text_(text), line_end_(text.find('\n') == std::string_view::npos ? '\r' : '\n') {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
}

std::string_view ObjStatements::take_line() {
  const std::size_t end = std::min(text_.find(line_end_), text_.size());
  std::string_view line = text_.substr(0, end);
  text_.remove_prefix(std::min(end + 1, text_.size()));
  ++lines_taken_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

bool ObjStatements::next() {
  while (!text_.empty()) {
    statement_ = take_line();
    line_ = lines_taken_;
    if (!statement_.empty() && statement_.back() == '\\') {
      joined_.clear();
      while (!statement_.empty() && statement_.back() == '\\') {
        joined_ += statement_.substr(0, statement_.size() - 1);
        joined_ += ' ';
        statement_ = text_.empty() ? std::string_view() : take_line();
      }
      joined_ += statement_;
      statement_ = joined_;
    }
    keyword_ = word();
    if (!keyword_.empty()) return true;
  }
  return false;
}

std::string_view ObjStatements::word() {
  std::size_t first = 0;
  while (first < statement_.size() && is_blank(statement_[first])) ++first;
  std::size_t end = first;
  while (end < statement_.size() && !is_blank(statement_[end])) ++end;
  const std::string_view found = statement_.substr(first, end - first);
  if (!found.empty() && found.front() == '#') {
    statement_ = {};
    return {};
  }
  statement_.remove_prefix(end);
  return found;
}

std::string_view ObjStatements::rest() {
  std::string_view left = std::exchange(statement_, {});
  while (!left.empty() && is_blank(left.front())) left.remove_prefix(1);
  while (!left.empty() && is_blank(left.back())) left.remove_suffix(1);
  return left;
}

std::string ObjStatements::place() const { return fmt::format("line {}", line_); }

double ObjStatements::number(std::string_view what) { return number(word(), what); }

double ObjStatements::number(std::string_view word, std::string_view what) const {
  if (word.empty()) fail(fmt::format("{} is missing; the file may be cut short", what));
  const bool has_plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  const char* const first = word.data() + (has_plus ? 1 : 0);
  const char* const last = word.data() + word.size();
  double value = 0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (end != last || error == std::errc::invalid_argument) {
    fail(fmt::format("{} should be a number but is {}", what, in_quotes(word)));
  }
  if (error == std::errc::result_out_of_range) {
    // Too small for a double is 0; too large is refused below.
    value = std::abs(std::strtod(std::string(first, last).c_str(), nullptr)) > 1 ? HUGE_VAL : 0.0;
  }
  if (!std::isfinite(value)) fail(fmt::format("{} is {}, which is not a finite number", what, in_quotes(word)));
  return value;
}

void ObjStatements::fail(std::string_view sentence) const { throw FileError(path_, place(), sentence); }

}  // namespace penumbra
