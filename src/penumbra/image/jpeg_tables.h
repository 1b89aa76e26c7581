#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace penumbra {

/// Looks at the Huffman tables of a JPEG before a decoder does: one of more than 256 codes, which no table can hold,
/// runs over its end in decoders that believe it. Walks from marker to marker (ITU-T T.81, annex B), through all scans.
/// Throws FileError about `name`.
void check_jpeg_tables(std::span<const std::byte> bytes, std::string_view name);

}  // namespace penumbra
