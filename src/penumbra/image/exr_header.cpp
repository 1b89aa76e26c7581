#include "penumbra/image/exr_header.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "penumbra/file/file_error.h"

namespace penumbra {
namespace {

using Bytes = std::span<const std::byte>;

/// Types whose values are of one length, in bytes.
constexpr std::array<std::pair<std::string_view, std::size_t>, 24> fixed_lengths{{{"box2f", 16},
                                                                                  {"box2i", 16},
                                                                                  {"chromaticities", 32},
                                                                                  {"compression", 1},
                                                                                  {"deepImageState", 1},
                                                                                  {"double", 8},
                                                                                  {"envmap", 1},
                                                                                  {"float", 4},
                                                                                  {"int", 4},
                                                                                  {"keycode", 28},
                                                                                  {"lineOrder", 1},
                                                                                  {"m33d", 72},
                                                                                  {"m33f", 36},
                                                                                  {"m44d", 128},
                                                                                  {"m44f", 64},
                                                                                  {"rational", 8},
                                                                                  {"tiledesc", 9},
                                                                                  {"timecode", 8},
                                                                                  {"v2d", 16},
                                                                                  {"v2f", 8},
                                                                                  {"v2i", 8},
                                                                                  {"v3d", 24},
                                                                                  {"v3f", 12},
                                                                                  {"v3i", 12}}};

std::uint64_t number(Bytes bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
  return value;
}

/// The text up to a zero, and the bytes without both; without a zero all of it.
std::string_view take_text(Bytes& bytes) {
  const auto zero = std::find(bytes.begin(), bytes.end(), std::byte{0});
  const auto length = static_cast<std::size_t>(zero - bytes.begin());
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), length);
  bytes = bytes.subspan(std::min(length + 1, bytes.size()));
  return text;
}

// Names, each with a type, flags and two samplings; an empty name ends them.
bool are_channels(Bytes value) {
  constexpr std::size_t channel = 16;
  while (!value.empty()) {
    if (take_text(value).empty()) return value.empty();
    if (value.size() < channel) return false;
    value = value.subspan(channel);
  }
  return false;
}

bool are_texts(Bytes value) {
  while (value.size() >= 4) {
    const std::uint64_t length = number(value, 0);
    if (length > value.size() - 4) return false;
    value = value.subspan(4 + static_cast<std::size_t>(length));
  }
  return value.empty();
}

bool is_thumbnail(Bytes value) {
  return value.size() >= 8 && number(value, 0) * number(value, 4) == (value.size() - 8) / 4 && value.size() % 4 == 0;
}

bool fits(std::string_view type, Bytes value) {
  if (type == "chlist") return are_channels(value);
  if (type == "stringvector") return are_texts(value);
  if (type == "preview") return is_thumbnail(value);
  if (type == "floatvector") return value.size() % 4 == 0;
  const auto fixed = std::ranges::find(fixed_lengths, type, [](const auto& entry) { return entry.first; });
  return fixed == fixed_lengths.end() || value.size() == fixed->second;
}

/// Takes a header off the bytes; false when it was empty.
bool take_header(Bytes& bytes, std::string_view name) {
  const auto fail = [&](std::string_view attribute, const char* what) {
    throw FileError(name, "", "cannot be decoded, the attribute " + std::string(attribute.substr(0, 40)) + what);
  };
  bool any = false;
  for (std::string_view attribute = take_text(bytes); !attribute.empty(); attribute = take_text(bytes)) {
    any = true;
    const std::string_view type = take_text(bytes);
    if (bytes.size() < 4 || number(bytes, 0) > bytes.size() - 4) fail(attribute, " reaches beyond the file's end");
    const auto length = static_cast<std::size_t>(number(bytes, 0));
    if (!fits(type, bytes.subspan(4, length))) fail(attribute, " is not as long as its type asks");
    bytes = bytes.subspan(4 + length);
  }
  return any;
}

}  // namespace

void check_exr_header(Bytes bytes, std::string_view name) {
  constexpr std::size_t head = 8;  // magic, version and flags
  constexpr std::byte several_parts{0x10};
  if (bytes.size() < head) throw FileError(name, "", "is cut short within its EXR header");
  const bool one = (bytes[5] & several_parts) == std::byte{0};
  bytes = bytes.subspan(head);
  while (take_header(bytes, name) && !one) {
  }
}

}  // namespace penumbra
