#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace penumbra {

/// Walks through the statements of an OBJ or MTL file: one a line, lines that end in a backslash joined with the next,
/// lines ended by \n, \r\n or \r, a word that starts with # beginning a comment.
class ObjStatements {
 public:
  /// @param path the file as the user named it, for messages.
  /// @param text must outlive this.
  ObjStatements(std::string path, std::string_view text);

  /// Goes to the next statement, past empty lines and comments; false at the end of the file.
  bool next();

  /// The first word of the statement.
  [[nodiscard]] std::string_view keyword() const { return keyword_; }
  /// The next word of the statement; empty at its end.
  std::string_view word();
  /// What is left of the statement, trimmed; comments are kept, because names may hold a #.
  std::string_view rest();
  /// The line that the statement starts on, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }
  /// "line 12".
  [[nodiscard]] std::string place() const;
  [[nodiscard]] const std::string& path() const { return path_; }

  /// The next word as a finite number in the C locale; FileError when it is missing or something else.
  /// @param what names the number in the message ("x of the position").
  double number(std::string_view what);
  /// A word as a finite number.
  [[nodiscard]] double number(std::string_view word, std::string_view what) const;

  /// Throws FileError at line().
  [[noreturn]] void fail(std::string_view sentence) const;

 private:
  std::string_view take_line();

  std::string path_;
  std::string_view text_;  ///< what is left of the file
  char line_end_;
  std::size_t lines_taken_ = 0;
  std::size_t line_ = 0;
  std::string joined_;
  std::string_view keyword_;
  std::string_view statement_;  ///< what is left of the statement
};

}  // namespace penumbra
