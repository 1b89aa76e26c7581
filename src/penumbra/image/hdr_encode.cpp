#include "penumbra/image/hdr_encode.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

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

}  // namespace

std::vector<std::byte> encode_hdr(const Image& image) {
  const std::string header =
      fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width);
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
