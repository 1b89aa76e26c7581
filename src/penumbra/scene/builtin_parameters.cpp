#include "penumbra/scene/builtin_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace penumbra {

namespace {

/// Whole numbers without a decimal point or an exponent, so that ranges read as people write them.
std::string number(double value) {
  return value == std::floor(value) && std::abs(value) < 1e15 ? fmt::format("{:.0f}", value) : fmt::format("{}", value);
}

double read_value(std::string_view scene, const BuiltinParameter& parameter, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc{} && end == text.data() + text.size();
  const bool fits = is_number && value >= parameter.lower && value <= parameter.upper &&
                    (!parameter.whole || value == std::floor(value));
  if (!fits) {
    throw std::invalid_argument(fmt::format("builtin:{}: {} must be {} from {} to {}, but is '{}'", scene,
                                            parameter.key, parameter.whole ? "a whole number" : "a number",
                                            number(parameter.lower), number(parameter.upper), text));
  }
  return value;
}

const BuiltinParameter& find(std::string_view scene, std::span<const BuiltinParameter> known, std::string_view key) {
  const auto found = std::ranges::find(known, key, &BuiltinParameter::key);
  if (found != known.end()) return *found;
  if (known.empty()) {
    throw std::invalid_argument(fmt::format("builtin:{} takes no parameters, but got '{}'", scene, key));
  }
  std::string keys;
  for (const BuiltinParameter& p : known) keys += fmt::format("{}{}", keys.empty() ? "" : ", ", p.key);
  throw std::invalid_argument(
      fmt::format("builtin:{} has no parameter '{}'; it knows {} (written key=value)", scene, key, keys));
}

}  // namespace

BuiltinParameters::BuiltinParameters(std::string_view scene, std::span<const BuiltinParameter> known,
                                     std::string_view text) {
  for (const BuiltinParameter& p : known) values_[std::string(p.key)] = p.fallback;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find('&'));
    text.remove_prefix(std::min(text.size(), pair.size() + 1));
    const std::string_view key = pair.substr(0, pair.find('='));
    const std::string_view value = pair.substr(std::min(pair.size(), key.size() + 1));
    values_[std::string(key)] = read_value(scene, find(scene, known, key), value);
  }
}

double BuiltinParameters::operator[](std::string_view key) const {
  const auto found = values_.find(key);
  assert(found != values_.end());
  return found->second;
}

std::string describe(std::span<const BuiltinParameter> parameters) {
  std::string text;
  for (const BuiltinParameter& p : parameters) {
    text += fmt::format("{}{}={} (default {}, {} to {}{}{})", text.empty() ? "" : "; ", p.key, p.whole ? "N" : "X",
                        number(p.fallback), number(p.lower), number(p.upper), p.unit.empty() ? "" : " ", p.unit);
  }
  return text;
}

}  // namespace penumbra
