#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "penumbra/io/json_value.h"

namespace penumbra {

/// A JSON value and where it stands ("accessor 3, sparse"), so that whatever is wrong with it can be said with its
/// place.
///
/// A view: file name and value must outlive it. Every access checks the type; a wrong one throws FileError.
class JsonPlace {
 public:
  JsonPlace(const JsonValue& value, const std::string& file, std::string place)
      : value_(&value), file_(&file), place_(std::move(place)) {}

  [[nodiscard]] const std::string& file() const { return *file_; }
  [[nodiscard]] const std::string& place() const { return place_; }

  /// Throws FileError with this file and place.
  [[noreturn]] void fail(std::string_view sentence) const;

  // Members of an object; each throws when this is no object, or the member is there and of another type.

  [[nodiscard]] bool has(std::string_view key) const;
  /// The member that must be an object, if it is there.
  [[nodiscard]] std::optional<JsonPlace> object(std::string_view key) const;
  /// The member that must be an array, if it is there.
  [[nodiscard]] std::optional<JsonPlace> list(std::string_view key) const;
  [[nodiscard]] bool flag(std::string_view key, bool fallback) const;
  [[nodiscard]] double number(std::string_view key, double fallback) const;
  [[nodiscard]] std::optional<double> number(std::string_view key) const;
  [[nodiscard]] std::string text(std::string_view key) const;  ///< empty when it is not there
  /// A whole number from 0 to 2^53.
  [[nodiscard]] std::optional<std::uint64_t> whole(std::string_view key) const;
  [[nodiscard]] std::uint64_t required_whole(std::string_view key) const;
  /// Exactly N finite numbers.
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers(std::string_view key, const std::array<double, N>& fallback) const {
    if (!has(key)) return fallback;
    std::array<double, N> values{};
    read_numbers(key, values.data(), N);
    return values;
  }
  /// Any count of finite numbers; none when it is not there.
  [[nodiscard]] std::vector<double> number_list(std::string_view key) const;
  /// The object `extras.NAME`, if it is there: extras of other programs may be of any kind and are passed over.
  [[nodiscard]] std::optional<JsonPlace> extras(std::string_view name) const;

  /// The extras as JSON text, without what is read from `extras.NAME`; empty when nothing is left.
  [[nodiscard]] std::string extras_without(std::string_view name) const;

  // Elements of an array; each throws when this is no array.

  [[nodiscard]] std::size_t size() const;
  /// Element i that must be an object, named "`noun` i". @pre i < size().
  [[nodiscard]] JsonPlace item(std::size_t i, std::string_view noun) const;
  /// Element i as a whole number. @pre i < size().
  [[nodiscard]] std::uint64_t whole_item(std::size_t i) const;
  /// Element i as a string. @pre i < size().
  [[nodiscard]] const std::string& text_item(std::size_t i) const;

 private:
  [[nodiscard]] const JsonValue* find(std::string_view key) const;
  [[nodiscard]] JsonPlace child(std::string_view key, const JsonValue& value) const;
  [[nodiscard]] std::uint64_t to_whole(std::string_view key, const JsonValue& value) const;
  [[nodiscard]] const JsonValue::Array& array() const;
  void read_numbers(std::string_view key, double* values, std::size_t count) const;

  const JsonValue* value_;
  const std::string* file_;
  std::string place_;
};

}  // namespace penumbra
