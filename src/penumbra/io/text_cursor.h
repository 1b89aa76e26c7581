#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace penumbra {

/// Walks through the words of a text file and knows on which line it stands, so that every complaint can name it.
///
/// Words are parted by blanks, tabs, commas and line ends (\n, \r\n or \r). A word that starts with the comment mark
/// ends its line.
class TextCursor {
 public:
  /// @param path the file as the user named it, for messages.
  /// @param text must outlive the cursor.
  /// @param comment the mark that begins a comment; '\0' for none.
  TextCursor(std::string path, std::string_view text, char comment = '\0');

  /// The next word on whatever line; empty at the end of the text.
  std::string_view word();
  /// The next word of the current line; empty at the line's end.
  std::string_view word_in_line();
  /// What is left of the current line, trimmed, comments kept.
  std::string_view rest_of_line();
  /// Goes to the next word, on whatever line; false when there is none.
  bool seek_word();
  /// Goes to the beginning of the line after this one; false at the end of the text.
  bool skip_line();

  /// The line of the word read last, from 1.
  [[nodiscard]] std::size_t line() const { return word_line_; }
  /// Where the next byte to read stands, from 0.
  [[nodiscard]] std::size_t offset() const { return at_; }

  /// The word as a finite number in the C locale, else a FileError that says which number ("x of vertex 3") was
  /// expected.
  [[nodiscard]] double number(std::string_view word, std::string_view what) const;
  /// The word as an integer within [least, most], else a FileError.
  [[nodiscard]] std::int64_t integer(std::string_view word, std::string_view what, std::int64_t least,
                                     std::int64_t most) const;

  /// Throws FileError at line().
  [[noreturn]] void fail(std::string_view sentence) const;

 private:
  void skip_blanks();
  [[nodiscard]] bool at_line_end() const;
  void pass_line_end();

  std::string path_;
  std::string_view text_;
  char comment_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  std::size_t word_line_ = 1;
};

/// A word or a piece of binary rubbish, fit to be quoted in one line of a message.
[[nodiscard]] std::string in_quotes(std::string_view word);

}  // namespace penumbra
