#include "penumbra/io/gltf_choice.h"

#include <fmt/format.h>

#include <charconv>

#include "penumbra/file/file_error.h"
#include "penumbra/io/text_cursor.h"

namespace penumbra {
namespace {

constexpr std::size_t most_shown = 12;

std::string shown(std::string_view name) {
  constexpr std::size_t longest = 60;
  return in_quotes(name.substr(0, longest));
}

}  // namespace

std::optional<std::uint64_t> chosen_gltf_item(const GltfDocument& document, std::string_view list,
                                              std::string_view noun, const std::optional<std::string>& choice) {
  const std::size_t count = document.count(list);
  if (!choice) return count > 0 ? std::optional<std::uint64_t>(0) : std::nullopt;
  std::string names;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = document.item(list, noun, i, document.root()).text("name");
    if (name == *choice) return i;
    if (i >= most_shown) continue;
    names += fmt::format("{}{}", i > 0 ? ", " : "", i);
    if (!name.empty()) names += fmt::format(" {}", shown(name));
  }
  std::uint64_t index = 0;
  const auto [end, error] = std::from_chars(choice->data(), choice->data() + choice->size(), index);
  if (error == std::errc{} && end == choice->data() + choice->size() && index < count) return index;
  if (count > most_shown) names += ", ...";
  throw FileError(document.file(), "",
                  count == 0 ? fmt::format("has no {}s, so {} {} is not there", noun, noun, shown(*choice))
                             : fmt::format("has no {} {}; it has {}", noun, shown(*choice), names));
}

}  // namespace penumbra
