#include "console.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "standard_error.h"

namespace penumbra::cli {
namespace {

constexpr std::chrono::milliseconds bar_interval{100};
constexpr std::chrono::milliseconds json_interval{250};
constexpr std::chrono::seconds line_interval{10};
constexpr double foreseeable = 0.01;  // below this share done, time left is a guess

std::string bar(double fraction) {
  constexpr int width = 28;
  const int filled = static_cast<int>(std::floor(fraction * width));
  return fmt::format("[{:#<{}}{:.<{}}]", "", filled, "", width - filled);
}

std::string duration(double seconds) {
  if (seconds < 60) return fmt::format("{:.0f} s", std::ceil(seconds));
  const int whole = static_cast<int>(std::min(seconds, 3.6e8));
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string line_for(std::string_view stage, double fraction, double elapsed) {
  std::string line = fmt::format("{} {:3.0f} %", stage, std::floor(fraction * 100));
  if (fraction >= foreseeable) line += ", " + duration(elapsed * (1 - fraction) / fraction) + " left";
  return line;
}

}  // namespace

Console::Console(const CommonOptions& options) : style_(style_for(options)), quiet_(options.quiet) {}

Console::~Console() { erase_bar(); }

Console::Style Console::style_for(const CommonOptions& options) {
  switch (options.progress) {
    case ProgressMode::bar:
      return Style::bar;
    case ProgressMode::json:
      return Style::json;
    case ProgressMode::off:
      return Style::none;
    case ProgressMode::automatic:
      break;
  }
  if (options.quiet) return Style::none;
  return ::isatty(STDERR_FILENO) == 1 ? Style::bar : Style::lines;
}

void Console::progress(std::string_view stage, double fraction) {
  if (style_ == Style::none) return;
  const bool fresh = stage != stage_;
  if (fresh) begin(stage);
  if (due(fraction) || (fresh && style_ != Style::lines)) draw(std::clamp(fraction, 0.0, 1.0));
}

void Console::begin(std::string_view stage) {
  stage_ = stage;
  stage_began_ = Clock::now();
  last_drawn_ = stage_began_;
}

bool Console::due(double fraction) const {
  const auto waited = Clock::now() - last_drawn_;
  switch (style_) {
    case Style::bar:
      return waited >= bar_interval;
    case Style::json:
      return waited >= json_interval || fraction >= 1;
    case Style::lines:
      return waited >= line_interval;
    case Style::none:
      break;
  }
  return false;
}

void Console::draw(double fraction) {
  last_drawn_ = Clock::now();
  const double elapsed = std::chrono::duration<double>(last_drawn_ - stage_began_).count();
  if (style_ == Style::json) {
    nlohmann::ordered_json line{
        {"stage", stage_}, {"fraction", fraction}, {"seconds", elapsed}, {"seconds_left", nullptr}};
    if (fraction >= foreseeable) line["seconds_left"] = elapsed * (1 - fraction) / fraction;
    write_standard_error(line.dump() + "\n");
  } else if (style_ == Style::lines) {
    write_standard_error(line_for(stage_, fraction, elapsed) + "\n");
  } else {
    write_standard_error(fmt::format("\r{} {}\x1b[K", bar(fraction), line_for(stage_, fraction, elapsed)));
    bar_shown_ = true;
  }
}

void Console::erase_bar() {
  if (!bar_shown_) return;
  write_standard_error("\r\x1b[K");
  bar_shown_ = false;
}

void Console::warn(std::string_view sentence) { say(fmt::format("warning: {}", sentence)); }

void Console::warn(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) warn(sentence);
}

void Console::say(std::string_view line) {
  if (!quiet_) insist(line);
}

void Console::insist(std::string_view line) {
  erase_bar();
  write_standard_error(std::string(line) + "\n");
}

}  // namespace penumbra::cli
