#pragma once

#include <span>
#include <string>
#include <string_view>

namespace penumbra::cli {

/// The known word that was probably meant, or an empty string when none is near: by edit distance (Damerau 1964,
/// with neighbours swapped), at most a third of the word's length.
[[nodiscard]] std::string nearest_word(std::string_view word, std::span<const std::string> known);

/// "; did you mean X?", or an empty string when no known word is near.
[[nodiscard]] std::string did_you_mean(std::string_view word, std::span<const std::string> known);

}  // namespace penumbra::cli
