#pragma once

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nearest_word.h"
#include "penumbra/math/vec.h"
#include "usage_error.h"

namespace penumbra::cli {

/// What the user gave for an option, and the option's name for the sentence when it makes no sense.
struct OptionValue {
  std::string option;  ///< "--spp"
  std::string text;
};

/// A whole number within [lowest, highest]. @param what it counts: "samples a pixel". Throws UsageError.
[[nodiscard]] long long whole_number(const OptionValue& value, long long lowest, long long highest,
                                     std::string_view what);

/// A finite number. @param what it measures, with the unit: "a number of seconds above 0". Throws UsageError.
[[nodiscard]] double real_number(const OptionValue& value, std::string_view what);

/// A finite number above 0. Throws UsageError.
[[nodiscard]] double number_above_zero(const OptionValue& value, std::string_view what);

/// Finite numbers with commas between, `count` of them. @param what they are, with an example. Throws UsageError.
[[nodiscard]] std::vector<double> number_list(const OptionValue& value, std::size_t count, std::string_view what);

/// Three numbers x,y,z. Throws UsageError.
[[nodiscard]] Vec3d triple(const OptionValue& value, std::string_view what);

/// Parts between commas; empty ones are kept.
[[nodiscard]] std::vector<std::string> split_at_commas(std::string_view text);

/// One of the named choices. Throws UsageError that lists them.
template <typename T>
[[nodiscard]] T choice(const OptionValue& value, std::span<const std::pair<std::string, T>> choices) {
  std::vector<std::string> names;
  for (const auto& [name, meaning] : choices) {
    if (name == value.text) return meaning;
    names.push_back(name);
  }
  throw UsageError(fmt::format("{} knows no '{}'{} (known: {})", value.option, value.text,
                               did_you_mean(value.text, names), fmt::join(names, ", ")));
}

}  // namespace penumbra::cli
