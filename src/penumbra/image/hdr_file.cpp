#include "penumbra/image/hdr_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/image/decode_limits.h"

namespace penumbra {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

float representable(float value) { return value > 0 ? std::min(value, 1.69e38F) : 0.0F; }

Rgbe to_rgbe(float red, float green, float blue) {
  red = representable(red);
  green = representable(green);
  blue = representable(blue);
  const float largest = std::max({red, green, blue});
  if (largest < 1e-38F) return {0, 0, 0, 0};
  int exponent = 0;
  std::frexp(largest, &exponent);
  // A largest mantissa that rounds to 256 needs the next exponent.
  if (std::lround(std::ldexp(largest, 8 - exponent)) > 255) ++exponent;
  const auto mantissa = [&](float v) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(std::ldexp(v, 8 - exponent)), 0L, 255L));
  };
  return {mantissa(red), mantissa(green), mantissa(blue), static_cast<std::uint8_t>(exponent + 128)};
}

// One component of a row: runs of 4 equal bytes or more as (128 + length, byte), the rest as (length, bytes...).
void append_runs(std::vector<std::uint8_t>& out, const std::vector<std::uint8_t>& row) {
  constexpr std::size_t shortest_run = 4;
  constexpr std::size_t longest_run = 127;
  constexpr std::size_t longest_literal = 128;
  const auto run_at = [&](std::size_t i) {
    std::size_t n = 1;
    while (n < longest_run && i + n < row.size() && row[i + n] == row[i]) ++n;
    return n;
  };
  for (std::size_t i = 0; i < row.size();) {
    if (const std::size_t run = run_at(i); run >= shortest_run) {
      out.push_back(static_cast<std::uint8_t>(128 + run));
      out.push_back(row[i]);
      i += run;
      continue;
    }
    std::size_t end = i + 1;
    while (end < row.size() && end - i < longest_literal && run_at(end) < shortest_run) ++end;
    out.push_back(static_cast<std::uint8_t>(end - i));
    out.insert(out.end(), row.begin() + static_cast<std::ptrdiff_t>(i), row.begin() + static_cast<std::ptrdiff_t>(end));
    i = end;
  }
}

/// Takes a Radiance file apart from front to back; every step is checked against its end.
class HdrReader {
 public:
  HdrReader(std::span<const std::byte> bytes, std::string_view name) : bytes_(bytes), name_(name) {}

  Image read() {
    read_header();
    const auto [width, height] = read_resolution();
    check_decode_limits(width, height, 3, bytes_.size(), name_);
    Image image(static_cast<int>(width), static_cast<int>(height));
    std::vector<Rgbe> row(static_cast<std::size_t>(width));
    for (int y = 0; y < image.height; ++y) {
      read_row(row);
      for (int x = 0; x < image.width; ++x) image.set_rgb(x, y, radiance(row[static_cast<std::size_t>(x)]));
    }
    return image;
  }

 private:
  [[noreturn]] void fail(std::string_view sentence) const {
    throw FileError(name_, fmt::format("byte {}", at_), sentence);
  }

  std::uint8_t next() {
    if (at_ >= bytes_.size()) fail("the picture ends too early; the file is cut short");
    return std::to_integer<std::uint8_t>(bytes_[at_++]);
  }

  std::string next_line() {
    std::string line;
    for (char c = static_cast<char>(next()); c != '\n'; c = static_cast<char>(next())) line += c;
    if (line.ends_with('\r')) line.pop_back();
    return line;
  }

  // Variables until an empty line; those that change what the numbers mean are heeded.
  void read_header() {
    for (std::string line = next_line(); !line.empty(); line = next_line()) {
      if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe") {
        fail("holds \"" + line + "\"; only FORMAT=32-bit_rle_rgbe is read");
      }
      if (!line.starts_with("EXPOSURE=")) continue;
      const std::size_t value_at = line.find_first_not_of(' ', std::string_view("EXPOSURE=").size());
      float exposure = 0;
      if (value_at != std::string::npos) std::from_chars(line.data() + value_at, line.data() + line.size(), exposure);
      if (!(exposure > 0) || !std::isfinite(exposure)) fail("the EXPOSURE is not a positive number");
      scale_ /= exposure;
    }
  }

  std::pair<std::int64_t, std::int64_t> read_resolution() {
    const std::string line = next_line();
    const auto number_after = [&](std::string_view axis) {
      std::int64_t value = -1;
      const std::size_t at = line.find(axis);
      if (at != std::string::npos) std::from_chars(line.data() + at + axis.size(), line.data() + line.size(), value);
      return value;
    };
    if (!line.starts_with("-Y "))
      fail("the resolution \"" + line.substr(0, 40) + "\" is not of the form -Y height +X width");
    return {number_after("+X "), number_after("-Y ")};
  }

  void read_row(std::vector<Rgbe>& row) {
    Rgbe first{};
    for (auto& v : first) v = next();
    const bool coded = row.size() >= 8 && row.size() < 32768 && first[0] == 2 && first[1] == 2 && first[2] < 128;
    if (coded) {
      if ((first[2] << 8 | first[3]) != static_cast<int>(row.size()))
        fail("a row is not as long as the picture is wide");
      for (std::size_t c = 0; c < 4; ++c) read_runs(row, c);
      return;
    }
    row[0] = first;
    for (std::size_t x = 1; x < row.size(); ++x) {
      for (auto& v : row[x]) v = next();
    }
    for (const Rgbe& p : row) {
      if (p[0] == 1 && p[1] == 1 && p[2] == 1) fail("the rows are run-length coded the old way; save it anew");
    }
  }

  void read_runs(std::vector<Rgbe>& row, std::size_t component) {
    for (std::size_t x = 0; x < row.size();) {
      const std::size_t code = next();
      const std::size_t length = code > 128 ? code - 128 : code;
      if (length == 0 || length > row.size() - x) fail("a run is longer than its row");
      const bool is_run = code > 128;
      std::uint8_t value = is_run ? next() : 0;
      for (const std::size_t end = x + length; x < end; ++x) {
        if (!is_run) value = next();
        row[x][component] = value;
      }
    }
  }

  [[nodiscard]] Rgb radiance(const Rgbe& p) const {
    if (p[3] == 0) return Rgb(0);
    const float unit = scale_ * std::ldexp(1.0F, p[3] - 136);
    return {static_cast<float>(p[0]) * unit, static_cast<float>(p[1]) * unit, static_cast<float>(p[2]) * unit};
  }

  std::span<const std::byte> bytes_;
  std::string_view name_;
  std::size_t at_ = 0;
  float scale_ = 1;
};

// One header line an entry; control characters, which could end it, become blanks.
std::string comments(const std::map<std::string, std::string>& metadata) {
  std::string lines;
  for (const auto& [key, text] : metadata) {
    std::string line = "# " + key + ": " + text;
    std::ranges::replace_if(
        line, [](unsigned char c) { return c < ' '; }, ' ');
    lines += line + "\n";
  }
  return lines;
}

}  // namespace

Image decode_hdr(std::span<const std::byte> bytes, std::string_view name) { return HdrReader(bytes, name).read(); }

std::vector<std::byte> encode_hdr(const Image& image) {
  const std::string header = fmt::format("#?RADIANCE\n{}FORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n",
                                         comments(image.metadata), image.height, image.width);
  std::vector<std::uint8_t> out(header.begin(), header.end());
  const auto width = static_cast<std::size_t>(image.width);
  const bool coded = width >= 8 && width < 32768;  // what the format can run-length code
  const std::size_t green = image.channels.size() >= 3 ? 1 : 0;
  std::array<std::vector<std::uint8_t>, 4> row;
  for (auto& component : row) component.resize(width);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* p = image.pixel(x, y);
      const Rgbe pixel = to_rgbe(p[0], p[green], p[2 * green]);
      for (std::size_t c = 0; c < 4; ++c) row[c][static_cast<std::size_t>(x)] = pixel[c];
      if (!coded) out.insert(out.end(), pixel.begin(), pixel.end());
    }
    if (!coded) continue;
    out.insert(out.end(), {2, 2, static_cast<std::uint8_t>(width >> 8), static_cast<std::uint8_t>(width & 255)});
    for (const auto& component : row) append_runs(out, component);
  }
  std::vector<std::byte> bytes(out.size());
  std::memcpy(bytes.data(), out.data(), out.size());
  return bytes;
}

}  // namespace penumbra
