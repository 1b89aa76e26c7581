#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace penumbra {

/// The whole file. Throws FileError when it is missing, a directory, unreadable, or larger than `max_bytes`.
[[nodiscard]] std::vector<std::byte> read_file(const std::filesystem::path& path,
                                               std::size_t max_bytes = std::size_t{8} << 30);

}  // namespace penumbra
