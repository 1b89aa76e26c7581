#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace penumbra {

/// A JSON document as plain values. Numbers are doubles (whole ones exact to 2^53); of members with the same name the
/// last one counts.
struct JsonValue {
  using Array = std::vector<JsonValue>;
  using Object = std::map<std::string, JsonValue, std::less<>>;

  std::variant<std::nullptr_t, bool, double, std::string, Array, Object> content = nullptr;

  [[nodiscard]] const Array* array() const { return std::get_if<Array>(&content); }
  [[nodiscard]] const Object* object() const { return std::get_if<Object>(&content); }
};

/// A value as JSON text, on one line.
[[nodiscard]] std::string json_text(const JsonValue& value);

/// The deepest nesting of arrays and objects that is read.
inline constexpr std::size_t max_json_depth = 128;

/// Parses UTF-8 JSON (RFC 8259). `path` is what errors call the file.
/// Throws FileError that names line and column when the text is no JSON or is nested deeper than `max_json_depth`.
[[nodiscard]] JsonValue parse_json(std::string_view text, const std::filesystem::path& path);

}  // namespace penumbra
