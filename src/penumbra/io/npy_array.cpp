#include "penumbra/io/npy_array.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <regex>
#include <stdexcept>

namespace penumbra {
namespace {

// One code point of UTF-8; what is not UTF-8 becomes U+FFFD.
char32_t take_code_point(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const std::size_t size = lead < 0x80 ? 1 : lead >= 0xF0 && lead < 0xF8 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC0 ? 2 : 0;
  char32_t point = lead < 0x80 ? lead : lead & (0xFFU >> (size + 1));
  bool good = size > 0 && size <= text.size() && lead < 0xF8;
  for (std::size_t i = 1; good && i < size; ++i) {
    good = (byte(i) & 0xC0U) == 0x80U;
    point = point << 6 | (byte(i) & 0x3FU);
  }
  good = good && point <= 0x10FFFF && !(point >= 0xD800 && point <= 0xDFFF);
  text.remove_prefix(good ? size : 1);
  return good ? point : U'\uFFFD';
}

std::u32string code_points(std::string_view text) {
  std::u32string points;
  while (!text.empty()) points += take_code_point(text);
  return points;
}

// A code point as UTF-8.
void append_utf8(std::string& text, char32_t p) {
  const auto byte = [&](char32_t b) { text += static_cast<char>(static_cast<unsigned char>(b)); };
  if (p < 0x80) {
    byte(p);
  } else if (p < 0x800) {
    byte(0xC0 | p >> 6);
    byte(0x80 | (p & 0x3F));
  } else if (p < 0x10000) {
    byte(0xE0 | p >> 12);
    byte(0x80 | (p >> 6 & 0x3F));
    byte(0x80 | (p & 0x3F));
  } else {
    byte(0xF0 | (p >> 18 & 0x07));
    byte(0x80 | (p >> 12 & 0x3F));
    byte(0x80 | (p >> 6 & 0x3F));
    byte(0x80 | (p & 0x3F));
  }
}

template <class T>
std::string array_of(std::string_view type, std::span<const T> values) {
  std::string array = npy_header(type, fmt::format("({},)", values.size()));
  array.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return array;
}

std::size_t bytes_of_type(const std::string& type) {
  static const std::regex pattern("[<|]([fiub]|U|S)([1-9][0-9]{0,5})");
  std::smatch match;
  if (!std::regex_match(type, match, pattern)) throw std::runtime_error(fmt::format("holds the unknown type {}", type));
  return std::stoul(match[2]) * (match[1] == "U" ? 4U : 1U);
}

template <class T>
std::vector<T> values_of(const NpyArray& array, const char* type) {
  if (array.type != type) throw std::runtime_error(fmt::format("holds {} where {} was expected", array.type, type));
  std::vector<T> values(array.size());
  if (!values.empty()) std::memcpy(values.data(), array.bytes.data(), values.size() * sizeof(T));
  return values;
}

}  // namespace

std::string npy_header(std::string_view type, std::string_view shape) {
  std::string literal = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  constexpr std::size_t before = 10;
  literal.append(63 - (before + literal.size()) % 64, ' ');
  literal += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(literal.size() & 0xFF);
  header += static_cast<char>(literal.size() >> 8);
  return header + literal;
}

std::string npy_array(std::span<const double> values) { return array_of("<f8", values); }

std::string npy_array(std::span<const std::int64_t> values) { return array_of("<i8", values); }

std::string npy_array(const std::vector<std::string>& texts) {
  std::vector<std::u32string> points;
  std::size_t width = 1;
  for (const std::string& text : texts) {
    points.push_back(code_points(text));
    width = std::max(width, points.back().size());
  }
  std::string array = npy_header(fmt::format("<U{}", width), fmt::format("({},)", texts.size()));
  for (std::u32string& text : points) {
    text.resize(width);
    array.append(reinterpret_cast<const char*>(text.data()), 4 * width);
  }
  return array;
}

std::string npy_truth(bool value) { return npy_header("|b1", "()") + std::string(1, value ? '\1' : '\0'); }

std::size_t NpyArray::size() const {
  std::size_t count = 1;
  for (const std::size_t n : shape) count *= n;
  return count;
}

NpyArray read_npy(std::string_view file) {
  constexpr std::size_t fixed = 10;
  if (file.size() < fixed || file.substr(0, 6) != "\x93NUMPY") throw std::runtime_error("is no NumPy array");
  if (file[6] != 1) throw std::runtime_error("is a NumPy array of a version other than 1");
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(file[i])); };
  const std::size_t length = byte(8) | byte(9) << 8U;
  if (file.size() - fixed < length) throw std::runtime_error("ends within its head");
  const std::string head(file.substr(fixed, length));
  static const std::regex pattern(
      R"(\{\s*'descr':\s*'([^']+)',\s*'fortran_order':\s*(False|True),\s*'shape':\s*\(([0-9, ]*)\),?\s*\}\s*)");
  std::smatch match;
  if (!std::regex_match(head, match, pattern)) throw std::runtime_error("has a head that is not understood");
  NpyArray array{.type = match[1], .shape = {}, .bytes = file.substr(fixed + length)};
  std::size_t bytes = bytes_of_type(array.type);
  const std::string shape = match[3];
  static const std::regex number("[0-9]+");
  for (std::sregex_iterator n(shape.begin(), shape.end(), number), end; n != end; ++n) {
    if (n->length() > 18) throw std::runtime_error("claims more values than it holds");
    array.shape.push_back(std::stoul(n->str()));
    if (array.shape.back() != 0 && bytes > array.bytes.size() / array.shape.back()) {
      throw std::runtime_error("claims more values than it holds");
    }
    bytes *= array.shape.back();
  }
  if (bytes > array.bytes.size()) throw std::runtime_error("claims more values than it holds");
  if (array.shape.size() > 1 && match[2] == "True") throw std::runtime_error("is stored column by column");
  array.bytes = array.bytes.substr(0, bytes);
  return array;
}

std::vector<double> doubles_of(const NpyArray& array) { return values_of<double>(array, "<f8"); }

std::vector<double> reals_of(const NpyArray& array) {
  if (array.type != "<f4") return doubles_of(array);
  const std::vector<float> narrow = values_of<float>(array, "<f4");
  return {narrow.begin(), narrow.end()};
}

std::vector<std::int64_t> integers_of(const NpyArray& array) { return values_of<std::int64_t>(array, "<i8"); }

std::vector<std::string> texts_of(const NpyArray& array) {
  if (array.type.substr(0, 2) != "<U") {
    throw std::runtime_error(fmt::format("holds {} where text was expected", array.type));
  }
  const std::size_t width = bytes_of_type(array.type) / 4;
  std::vector<std::string> texts(array.size());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    for (std::size_t k = 0; k < width; ++k) {
      char32_t point = 0;
      std::memcpy(&point, array.bytes.data() + 4 * (i * width + k), 4);
      if (point != 0) append_utf8(texts[i], point > 0x10FFFF ? U'\uFFFD' : point);
    }
  }
  return texts;
}

}  // namespace penumbra
