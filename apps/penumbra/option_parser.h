#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "option_value.h"

namespace penumbra::cli {

/// The options of one command: reads them, explains them, and says in one sentence what is wrong with them.
class OptionParser {
 public:
  using Take = std::function<void(const OptionValue&)>;

  /// @param command "render". @param usage what follows it: "SCENE -o IMAGE [options]".
  /// @param summary one line that says what the command does.
  OptionParser(std::string command, std::string usage, std::string summary);

  /// Headline for the options that are added next.
  void group(std::string title);
  /// An argument without a name of its own, in order.
  void positional(std::string name, std::string help, std::string& target);
  /// @param names "-q,--quiet".
  /// Any number of arguments without names.
  void positionals(std::string name, std::string help, std::vector<std::string>& target);
  void flag(std::string names, std::string help, bool& target);
  /// An option with a value; given twice, the last one counts. @param metavar "N".
  void value(std::string names, std::string metavar, std::string help, Take take);
  /// An option with one value or more; given twice, all count.
  void values(std::string names, std::string metavar, std::string help, std::vector<std::string>& target);
  /// An option with one value that may be given several times; all count.
  void repeated(std::string names, std::string metavar, std::string help, Take take);
  /// Two command lines to learn from, shown last.
  void examples(std::vector<std::string> lines);

  /// Hands every value to its taker. False when the user asked for help, which was printed. Throws UsageError.
  [[nodiscard]] bool parse(const std::vector<std::string>& arguments) const;

 private:
  enum class Kind { positional, flag, value };
  struct Entry {
    Kind kind;
    std::string group, names, metavar, help;
    Take take;
    bool many = false;      ///< one value or more
    bool repeated = false;  ///< one value, several times
  };

  [[nodiscard]] std::string help() const;
  [[noreturn]] void refuse_extras(const std::vector<std::string>& extras) const;

  std::string command_, usage_, summary_, group_;
  std::vector<Entry> entries_;
  std::vector<std::string> examples_;
};

}  // namespace penumbra::cli
