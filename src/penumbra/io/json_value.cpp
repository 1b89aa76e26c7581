#include "penumbra/io/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "penumbra/file/file_error.h"

namespace penumbra {
namespace {

/// Builds the value while nlohmann's parser, which does not recurse, walks the text.
class JsonBuilder {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  struct Failure {
    std::size_t byte = 0;
    std::string sentence;
  };

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(number_integer_t value) { return add(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) { return add(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t& /*text*/) { return add(value); }
  bool string(string_t& value) { return add(std::move(value)); }
  bool binary(binary_t& /*value*/) { return false; }
  bool start_object(std::size_t /*size*/) { return open(JsonValue::Object{}); }
  bool start_array(std::size_t /*size*/) { return open(JsonValue::Array{}); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(string_t& name) {
    key_ = std::move(name);
    return true;
  }
  bool parse_error(std::size_t byte, const std::string& /*token*/, const nlohmann::detail::exception& error) {
    failure_ = Failure{byte, sentence_of(error)};
    return false;
  }

  [[nodiscard]] JsonValue take() { return std::move(root_); }
  [[nodiscard]] const std::optional<Failure>& failure() const { return failure_; }

 private:
  template <class Content>
  JsonValue* place(Content&& content) {
    if (open_.empty()) {
      root_.content = std::forward<Content>(content);
      return &root_;
    }
    if (auto* array = std::get_if<JsonValue::Array>(&open_.back()->content)) {
      return &array->emplace_back(JsonValue{std::forward<Content>(content)});
    }
    auto& object = std::get<JsonValue::Object>(open_.back()->content);
    return &object.insert_or_assign(std::move(key_), JsonValue{std::forward<Content>(content)}).first->second;
  }
  template <class Content>
  bool add(Content&& content) {
    place(std::forward<Content>(content));
    return true;
  }
  // A container stays where it is while it is open: its parent grows only after it closes.
  template <class Content>
  bool open(Content&& content) {
    if (open_.size() >= max_json_depth) {
      failure_ =
          Failure{0, fmt::format("its JSON is nested deeper than {} levels, which no glTF needs", max_json_depth)};
      return false;
    }
    open_.push_back(place(std::forward<Content>(content)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ..." without its head.
  static std::string sentence_of(const std::exception& error) {
    std::string text = error.what();
    if (const auto head = text.find("] "); head != std::string::npos) text.erase(0, head + 2);
    if (const auto colon = text.find(": "); text.starts_with("parse error") && colon != std::string::npos) {
      text.erase(0, colon + 2);
    }
    constexpr std::size_t longest = 160;
    if (text.size() > longest) text = text.substr(0, longest) + "...";
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 32 || c > 126; }, '?');
    return "is not valid JSON (" + text + "); export the file again";
  }

  JsonValue root_;
  std::vector<JsonValue*> open_;
  std::string key_;
  std::optional<Failure> failure_;
};

std::string line_and_column(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte == 0 ? 0 : byte - 1, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const auto last_break = before.rfind('\n');
  const auto column = last_break == std::string_view::npos ? before.size() + 1 : before.size() - last_break;
  return fmt::format("line {}, column {}", line, column);
}

using Replace = nlohmann::json::error_handler_t;

// Nesting was bounded when the value was parsed.
nlohmann::ordered_json as_nlohmann(const JsonValue& value) {
  if (const auto* array = value.array()) {
    auto made = nlohmann::ordered_json::array();
    for (const JsonValue& element : *array) made.push_back(as_nlohmann(element));
    return made;
  }
  if (const auto* object = value.object()) {
    auto made = nlohmann::ordered_json::object();
    for (const auto& [name, member] : *object) made[name] = as_nlohmann(member);
    return made;
  }
  if (const auto* text = std::get_if<std::string>(&value.content)) return *text;
  if (const auto* flag = std::get_if<bool>(&value.content)) return *flag;
  const auto* number = std::get_if<double>(&value.content);
  if (number == nullptr) return nullptr;
  const bool whole = std::abs(*number) <= 0x1p53 && std::floor(*number) == *number;
  return whole ? nlohmann::ordered_json(static_cast<std::int64_t>(*number)) : nlohmann::ordered_json(*number);
}

}  // namespace

JsonValue parse_json(std::string_view text, const std::filesystem::path& path) {
  JsonBuilder builder;
  const bool whole = nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  if (const auto& failure = builder.failure()) {
    throw FileError(path.string(), failure->byte == 0 ? "" : line_and_column(text, failure->byte), failure->sentence);
  }
  if (!whole) throw FileError(path.string(), "", "is not valid JSON; export the file again");
  return builder.take();
}

std::string json_text(const JsonValue& value) { return as_nlohmann(value).dump(-1, ' ', false, Replace::replace); }

}  // namespace penumbra
