#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// The bytes of a `data:` URI (RFC 2397; base64 or percent-encoded), or nothing for another kind of URI.
/// Throws std::invalid_argument with what is wrong ("its base64 data ...") when the data are damaged.
[[nodiscard]] std::optional<std::vector<std::byte>> data_uri_bytes(std::string_view uri);

/// The file that a relative URI of a glTF names, percent-decoded, as a path relative to the folder of the glTF.
/// Throws std::invalid_argument with what is wrong for an absolute path, one that leaves the folder by `..`, or a URI
/// with a scheme such as http: or file:.
[[nodiscard]] std::filesystem::path relative_uri_path(std::string_view uri);

}  // namespace penumbra
