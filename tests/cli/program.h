#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::test {

/// How a run of the program ended and what it said.
struct Outcome {
  int code = -1;  ///< exit code; 1000 + the signal's number when one killed it
  std::string out;
  std::string err;

  [[nodiscard]] nlohmann::json report() const { return nlohmann::json::parse(out); }
};

/// A folder that the test alone uses, gone with it.
class Workshop {
 public:
  Workshop();
  ~Workshop();
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;

  [[nodiscard]] std::string path(std::string_view name) const { return (folder_ / name).string(); }
  /// Writes a file and returns its path.
  std::string file(std::string_view name, std::string_view text) const;
  /// Names of what lies in it now, sorted.
  [[nodiscard]] std::vector<std::string> contents() const;

 private:
  std::filesystem::path folder_;
};

/// Runs the built program to its end.
[[nodiscard]] Outcome penumbra(const std::vector<std::string>& arguments);
/// Runs any command to its end.
[[nodiscard]] Outcome command(const std::vector<std::string>& words);

/// The program while it runs.
class Running {
 public:
  explicit Running(const std::vector<std::string>& arguments);
  /// Waits until standard error holds `text`; false after 20 s or when the program ended.
  [[nodiscard]] bool says(std::string_view text);
  void signal(int number) const;
  /// Waits for its end.
  [[nodiscard]] Outcome end();

 private:
  Workshop pipes_;
  pid_t process_ = -1;
  bool reaped_ = false;
  int status_ = 0;
};

/// The whole file.
[[nodiscard]] std::string read_text(const std::string& path);

}  // namespace penumbra::test
