#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "penumbra/io/gltf_document.h"

namespace penumbra {

/// Which element of a top-level list a user means by its name or, when none bears it, its index from 0. Without a
/// choice the first; nothing when the list is empty. Throws FileError that names what there is.
[[nodiscard]] std::optional<std::uint64_t> chosen_gltf_item(const GltfDocument& document, std::string_view list,
                                                            std::string_view noun,
                                                            const std::optional<std::string>& choice);

}  // namespace penumbra
