#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace penumbra {

/// The file that another file names, as a path relative to that file's folder (backslashes part folders too), or
/// nothing when the name is empty, absolute, or leaves the folder by "..": a scene may only read what lies beside it.
[[nodiscard]] std::optional<std::filesystem::path> asset_path(std::string_view name);

}  // namespace penumbra
