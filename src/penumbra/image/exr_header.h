#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace penumbra {

/// Looks at the headers of an EXR before OpenEXR does, which takes memory for whatever length an attribute claims.
/// Every attribute must lie within the file and be as long as its type says (OpenEXR file layout, "Header"), so that
/// nothing is read at another place than here. Throws FileError about `name`.
void check_exr_header(std::span<const std::byte> bytes, std::string_view name);

}  // namespace penumbra
