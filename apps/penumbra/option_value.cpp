#include "option_value.h"

#include <charconv>
#include <cmath>
#include <optional>

namespace penumbra::cli {
namespace {

template <typename Number>
std::optional<Number> parsed(std::string_view text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return number;
}

std::optional<double> finite(std::string_view text) {
  const auto number = parsed<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

[[noreturn]] void refuse(const OptionValue& value, std::string_view what) {
  throw UsageError(fmt::format("{} takes {}, not '{}'", value.option, what, value.text));
}

}  // namespace

long long whole_number(const OptionValue& value, long long lowest, long long highest, std::string_view what) {
  const auto number = parsed<long long>(value.text);
  if (!number || *number < lowest || *number > highest) {
    refuse(value, fmt::format("a whole number of {} from {} to {}", what, lowest, highest));
  }
  return *number;
}

double real_number(const OptionValue& value, std::string_view what) {
  const auto number = finite(value.text);
  if (!number) refuse(value, what);
  return *number;
}

double number_above_zero(const OptionValue& value, std::string_view what) {
  const double number = real_number(value, what);
  if (!(number > 0)) throw UsageError(fmt::format("{} takes {}, not '{}'", value.option, what, value.text));
  return number;
}

std::vector<double> number_list(const OptionValue& value, std::size_t count, std::string_view what) {
  std::vector<double> numbers;
  for (const std::string& part : split_at_commas(value.text)) {
    const auto number = finite(part);
    if (!number) refuse(value, what);
    numbers.push_back(*number);
  }
  if (numbers.size() != count) refuse(value, what);
  return numbers;
}

Vec3d triple(const OptionValue& value, std::string_view what) {
  const auto numbers = number_list(value, 3, what);
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<std::string> split_at_commas(std::string_view text) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t comma = text.find(',');
    parts.emplace_back(text.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace penumbra::cli
