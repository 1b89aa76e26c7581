#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "common_options.h"

namespace penumbra::cli {

/// What the program says on standard error while it works: progress, warnings, and the closing line.
class Console {
 public:
  explicit Console(const CommonOptions& options);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// How far a stage has come, 0..1. Called from one thread at a time.
  void progress(std::string_view stage, double fraction);
  /// One sentence, unless quiet.
  void warn(std::string_view sentence);
  void warn(const std::vector<std::string>& sentences);
  /// A line, unless quiet.
  void say(std::string_view line);
  /// A line that is said in any case.
  void insist(std::string_view line);

 private:
  using Clock = std::chrono::steady_clock;
  enum class Style { none, bar, lines, json };

  [[nodiscard]] static Style style_for(const CommonOptions& options);
  void begin(std::string_view stage);
  [[nodiscard]] bool due(double fraction) const;
  void draw(double fraction);
  void erase_bar();

  Style style_;
  bool quiet_;
  bool bar_shown_ = false;
  std::string stage_;
  Clock::time_point stage_began_;
  Clock::time_point last_drawn_;
};

}  // namespace penumbra::cli
