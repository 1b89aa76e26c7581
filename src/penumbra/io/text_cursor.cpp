#include "penumbra/io/text_cursor.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "penumbra/file/file_error.h"

namespace penumbra {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\0' || c == '\v' || c == '\f'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }

// std::from_chars takes no plus sign, people's files do.
std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

}  // namespace

std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string out = "'";
  for (const char c : word.substr(0, longest)) out += (c >= ' ' && c < '\x7f') ? c : '?';
  return out + (word.size() > longest ? "...'" : "'");
}

TextCursor::TextCursor(std::string path, std::string_view text, char comment)
    : path_(std::move(path)), text_(text), comment_(comment) {}

void TextCursor::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  if (comment_ != '\0' && at_ < text_.size() && text_[at_] == comment_) {
    while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
  }
}

bool TextCursor::at_line_end() const { return at_ >= text_.size() || is_line_end(text_[at_]); }

void TextCursor::pass_line_end() {
  if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
  ++at_;
  ++line_;
}

std::string_view TextCursor::word_in_line() {
  skip_blanks();
  const std::size_t first = at_;
  while (!at_line_end() && !is_blank(text_[at_])) ++at_;
  word_line_ = line_;
  return text_.substr(first, at_ - first);
}

std::string_view TextCursor::word() {
  if (!seek_word()) {
    word_line_ = line_;
    return {};
  }
  return word_in_line();
}

std::string_view TextCursor::rest_of_line() {
  const std::size_t first = at_;
  while (!at_line_end()) ++at_;
  std::string_view rest = text_.substr(first, at_ - first);
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
  while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
  word_line_ = line_;
  return rest;
}

bool TextCursor::seek_word() {
  for (skip_blanks(); at_ < text_.size() && at_line_end(); skip_blanks()) pass_line_end();
  return at_ < text_.size();
}

bool TextCursor::skip_line() {
  while (!at_line_end()) ++at_;
  if (at_ < text_.size()) pass_line_end();
  return at_ < text_.size();
}

double TextCursor::number(std::string_view word, std::string_view what) const {
  if (word.empty()) fail(fmt::format("{} is missing; the file may be cut short", what));
  const std::string_view digits = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || (error != std::errc{} && error != std::errc::result_out_of_range)) {
    fail(fmt::format("{} should be a number but is {}", what, in_quotes(word)));
  }
  // What is too small for a double is 0; what is too large is no length.
  if (error == std::errc::result_out_of_range) {
    value = std::abs(std::strtod(std::string(digits).c_str(), nullptr)) > 1 ? HUGE_VAL : 0.0;
  }
  if (!std::isfinite(value)) fail(fmt::format("{} is {}; only finite numbers make a mesh", what, in_quotes(word)));
  return value;
}

std::int64_t TextCursor::integer(std::string_view word, std::string_view what, std::int64_t least,
                                 std::int64_t most) const {
  if (word.empty()) fail(fmt::format("{} is missing; the file may be cut short", what));
  const std::string_view digits = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || error != std::errc{}) {
    fail(fmt::format("{} should be a whole number but is {}", what, in_quotes(word)));
  }
  if (value < least || value > most) {
    fail(fmt::format("{} is {}, but should be from {} to {}", what, value, least, most));
  }
  return value;
}

void TextCursor::fail(std::string_view sentence) const {
  throw FileError(path_, fmt::format("line {}", word_line_), sentence);
}

}  // namespace penumbra
