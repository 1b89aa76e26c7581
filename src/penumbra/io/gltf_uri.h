#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// The bytes of a `data:` URI (RFC 2397; base64 or percent-encoded), or nothing for another kind of URI.
/// Throws std::invalid_argument with what is wrong ("its base64 data ...") when the data are damaged.
[[nodiscard]] std::optional<std::vector<std::byte>> data_uri_bytes(std::string_view uri);

/// The file name that a URI of a glTF holds, percent-decoded.
/// Throws std::invalid_argument with what is wrong for a URI with a scheme such as http: or file:.
[[nodiscard]] std::string uri_file_name(std::string_view uri);

/// A URI in a message: its beginning, printable.
[[nodiscard]] std::string shown_uri(std::string_view uri);

}  // namespace penumbra
