#include "penumbra/io/json_place.h"

#include <fmt/format.h>

#include "penumbra/file/file_error.h"

namespace penumbra {
namespace {

const char* kind_of(const JsonValue& value) {
  constexpr const char* names[] = {"null", "true or false", "a number", "a string", "an array", "an object"};
  return names[value.content.index()];
}

}  // namespace

void JsonPlace::fail(std::string_view sentence) const { throw FileError(*file_, place_, sentence); }

const JsonValue* JsonPlace::find(std::string_view key) const {
  const auto* object = value_->object();
  if (object == nullptr) fail(fmt::format("must be an object but is {}; export the file again", kind_of(*value_)));
  const auto member = object->find(key);
  return member == object->end() ? nullptr : &member->second;
}

JsonPlace JsonPlace::child(std::string_view key, const JsonValue& value) const {
  return {value, *file_, place_.empty() ? std::string(key) : fmt::format("{}, {}", place_, key)};
}

bool JsonPlace::has(std::string_view key) const { return find(key) != nullptr; }

std::optional<JsonPlace> JsonPlace::object(std::string_view key) const {
  const JsonValue* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->object() == nullptr)
    fail(fmt::format("{} must be an object but is {}; export the file again", key, kind_of(*value)));
  return child(key, *value);
}

std::optional<JsonPlace> JsonPlace::list(std::string_view key) const {
  const JsonValue* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->array() == nullptr)
    fail(fmt::format("{} must be an array but is {}; export the file again", key, kind_of(*value)));
  return child(key, *value);
}

bool JsonPlace::flag(std::string_view key, bool fallback) const {
  const JsonValue* value = find(key);
  if (value == nullptr) return fallback;
  if (const auto* flag = std::get_if<bool>(&value->content)) return *flag;
  fail(fmt::format("{} must be true or false but is {}; export the file again", key, kind_of(*value)));
}

std::optional<double> JsonPlace::number(std::string_view key) const {
  const JsonValue* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (const auto* number = std::get_if<double>(&value->content); number != nullptr && std::isfinite(*number)) {
    return *number;
  }
  fail(fmt::format("{} must be a finite number but is {}; export the file again", key, kind_of(*value)));
}

double JsonPlace::number(std::string_view key, double fallback) const { return number(key).value_or(fallback); }

std::string JsonPlace::text(std::string_view key) const {
  const JsonValue* value = find(key);
  if (value == nullptr) return {};
  if (const auto* text = std::get_if<std::string>(&value->content)) return *text;
  fail(fmt::format("{} must be a string but is {}; export the file again", key, kind_of(*value)));
}

std::uint64_t JsonPlace::to_whole(std::string_view key, const JsonValue& value) const {
  const auto* number = std::get_if<double>(&value.content);
  if (number == nullptr)
    fail(fmt::format("{} must be a whole number but is {}; export the file again", key, kind_of(value)));
  if (!(*number >= 0 && *number <= 0x1p53) || std::floor(*number) != *number) {
    fail(fmt::format("{} must be a whole number of at least 0 but is {}; export the file again", key, *number));
  }
  return static_cast<std::uint64_t>(*number);
}

std::optional<std::uint64_t> JsonPlace::whole(std::string_view key) const {
  const JsonValue* value = find(key);
  if (value == nullptr) return std::nullopt;
  return to_whole(key, *value);
}

std::uint64_t JsonPlace::required_whole(std::string_view key) const {
  if (const auto value = whole(key)) return *value;
  fail(fmt::format("has no {}, which glTF requires; export the file again", key));
}

void JsonPlace::read_numbers(std::string_view key, double* values, std::size_t count) const {
  const auto numbers = list(key);
  const auto& elements = numbers->array();
  if (elements.size() != count)
    fail(fmt::format("{} must hold {} numbers but holds {}; export the file again", key, count, elements.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const auto* number = std::get_if<double>(&elements[i].content);
    if (number == nullptr || !std::isfinite(*number)) {
      fail(fmt::format("{} must hold finite numbers but element {} is {}; export the file again", key, i,
                       kind_of(elements[i])));
    }
    values[i] = *number;
  }
}

std::vector<double> JsonPlace::number_list(std::string_view key) const {
  const auto numbers = list(key);
  std::vector<double> values(numbers ? numbers->size() : 0);
  if (!values.empty()) read_numbers(key, values.data(), values.size());
  return values;
}

std::optional<JsonPlace> JsonPlace::extras(std::string_view name) const {
  const JsonValue* extras = find("extras");
  if (extras == nullptr || extras->object() == nullptr) return std::nullopt;
  return child("extras", *extras).object(name);
}

std::string JsonPlace::extras_without(std::string_view name) const {
  const JsonValue* extras = find("extras");
  if (extras == nullptr) return {};
  if (extras->object() == nullptr) return json_text(*extras);
  JsonValue::Object kept = *extras->object();
  if (const auto found = kept.find(name); found != kept.end()) kept.erase(found);
  return kept.empty() ? std::string() : json_text(JsonValue{std::move(kept)});
}

const JsonValue::Array& JsonPlace::array() const {
  if (const auto* elements = value_->array()) return *elements;
  fail(fmt::format("must be an array but is {}; export the file again", kind_of(*value_)));
}

std::size_t JsonPlace::size() const { return array().size(); }

JsonPlace JsonPlace::item(std::size_t i, std::string_view noun) const {
  const JsonValue& value = array()[i];
  JsonPlace place(value, *file_, fmt::format("{} {}", noun, i));
  if (value.object() == nullptr)
    place.fail(fmt::format("must be an object but is {}; export the file again", kind_of(value)));
  return place;
}

std::uint64_t JsonPlace::whole_item(std::size_t i) const { return to_whole(fmt::format("element {}", i), array()[i]); }

const std::string& JsonPlace::text_item(std::size_t i) const {
  const JsonValue& value = array()[i];
  if (const auto* text = std::get_if<std::string>(&value.content)) return *text;
  fail(fmt::format("element {} must be a string but is {}; export the file again", i, kind_of(value)));
}

}  // namespace penumbra
