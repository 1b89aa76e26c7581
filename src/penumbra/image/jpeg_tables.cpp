#include "penumbra/image/jpeg_tables.h"

#include <algorithm>

#include "penumbra/file/file_error.h"

namespace penumbra {
namespace {

constexpr std::size_t longest_table = 256;

std::size_t byte_at(std::span<const std::byte> bytes, std::size_t i) { return std::to_integer<std::size_t>(bytes[i]); }

/// Where the marker's code stands that comes next at or after `at`: not a fill byte, and in data of a scan not an
/// escaped 0xFF or a restart. The end when there is none.
std::size_t next_marker(std::span<const std::byte> bytes, std::size_t at) {
  for (; at + 1 < bytes.size(); ++at) {
    if (byte_at(bytes, at) != 0xFF) continue;
    const std::size_t code = byte_at(bytes, at + 1);
    const bool in_scan = code == 0 || (code >= 0xD0 && code <= 0xD7);
    if (code != 0xFF && !in_scan) return at + 1;
  }
  return bytes.size();
}

/// Tables one after another from `at` to `end`: class and number, how many codes there are of each length from 1 to 16,
/// their values. The last may run over the end, of the file too; a decoder sees that when it is too late.
void check_huffman_tables(std::span<const std::byte> bytes, std::size_t at, std::size_t end, std::string_view name) {
  constexpr std::size_t head = 17;
  while (at < end) {
    std::size_t codes = 0;
    for (std::size_t i = at + 1; i < std::min(at + head, bytes.size()); ++i) codes += byte_at(bytes, i);
    if (codes > longest_table) {
      throw FileError(name, "", "cannot be decoded, it is damaged (a Huffman table of more than 256 codes)");
    }
    at += head + codes;
  }
}

}  // namespace

void check_jpeg_tables(std::span<const std::byte> bytes, std::string_view name) {
  constexpr std::size_t begin = 0xD8, end = 0xD9, huffman_tables = 0xC4;
  std::size_t at = next_marker(bytes, 0);
  while (at + 2 < bytes.size()) {
    const std::size_t code = byte_at(bytes, at);
    if (code == begin || code == end) {  // what follows an end is not looked at by those who heed it
      at = next_marker(bytes, at + 1);
      continue;
    }
    const std::size_t length = byte_at(bytes, at + 1) << 8 | byte_at(bytes, at + 2);
    const std::size_t after = std::min(at + 1 + std::max<std::size_t>(length, 2), bytes.size());
    if (code == huffman_tables) check_huffman_tables(bytes, at + 3, after, name);
    at = next_marker(bytes, after);
  }
}

}  // namespace penumbra
