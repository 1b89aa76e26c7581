#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string>

#include "penumbra/image/image_io.h"
#include "penumbra/parallel/parallel_for.h"

// PNG (W3C, third edition): one filter for every row and zlib at its fastest. The picture is cut into bands of fixed
// size that are deflated apart and joined, each in an IDAT chunk of its own, so the bytes do not depend on threads.

namespace penumbra {
namespace {

constexpr std::size_t band_bytes = std::size_t{1} << 18;

/// A run of rows, filtered and deflated.
struct Band {
  std::vector<std::uint8_t> deflated;
  uLong adler = 0;
  std::size_t filtered_bytes = 0;
};

void append_u32(std::vector<std::uint8_t>& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

void append_chunk(std::vector<std::uint8_t>& out, const char* type, std::span<const std::uint8_t> data) {
  append_u32(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = out.size();
  out.insert(out.end(), type, type + 4);
  out.insert(out.end(), data.begin(), data.end());
  append_u32(out, static_cast<std::uint32_t>(crc32_z(0, out.data() + start, out.size() - start)));
}

// An iTXt chunk: keyword, no compression, no language, no translated keyword, UTF-8 text.
void append_text(std::vector<std::uint8_t>& out, const std::string& keyword, const std::string& text) {
  std::vector<std::uint8_t> data(keyword.begin(), keyword.end());
  data.insert(data.end(), {0, 0, 0, 0, 0});
  data.insert(data.end(), text.begin(), text.end());
  append_chunk(out, "iTXt", data);
}

// Filter type 1: each byte less the one a pixel to its left.
std::vector<std::uint8_t> filtered_rows(const Image8& image, std::size_t first, std::size_t last) {
  const auto pixel = static_cast<std::size_t>(image.channels);
  const std::size_t stride = static_cast<std::size_t>(image.width) * pixel;
  std::vector<std::uint8_t> out((stride + 1) * (last - first));
  std::uint8_t* to = out.data();
  for (std::size_t y = first; y < last; ++y) {
    const std::uint8_t* row = image.data.data() + y * stride;
    *to++ = 1;
    std::memcpy(to, row, pixel);
    for (std::size_t i = pixel; i < stride; ++i) to[i] = static_cast<std::uint8_t>(row[i] - row[i - pixel]);
    to += stride;
  }
  return out;
}

std::vector<std::uint8_t> deflated(std::span<std::uint8_t> data, bool is_last) {
  z_stream stream{};
  if (deflateInit2(&stream, 1, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::vector<std::uint8_t> out(deflateBound(&stream, data.size()) + 16);
  stream.next_in = data.data();
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  const int result = deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH);
  const bool whole = result == (is_last ? Z_STREAM_END : Z_OK) && stream.avail_in == 0;
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (!whole) throw std::runtime_error("zlib did not take a PNG band whole");
  return out;
}

std::vector<Band> deflated_bands(const Image8& image) {
  const auto height = static_cast<std::size_t>(image.height);
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels) + 1;
  const std::size_t rows = std::max<std::size_t>(1, band_bytes / row_bytes);
  std::vector<Band> bands((height + rows - 1) / rows);
  parallel_for(bands.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      auto filtered = filtered_rows(image, b * rows, std::min(height, (b + 1) * rows));
      bands[b].adler = adler32_z(1, filtered.data(), filtered.size());
      bands[b].filtered_bytes = filtered.size();
      bands[b].deflated = deflated(filtered, b + 1 == bands.size());
    }
  });
  return bands;
}

}  // namespace

std::vector<std::byte> encode_png(const Image8& image, const std::map<std::string, std::string>& texts) {
  const auto samples = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                       static_cast<std::size_t>(image.channels);
  if (image.width < 1 || image.height < 1 || image.channels < 1 || image.channels > 4 || image.data.size() != samples) {
    throw std::invalid_argument(
        "a PNG picture needs a width and height of 1 or more, 1 to 4 channels and all its texels");
  }
  static constexpr std::array<std::uint8_t, 4> colour_types{0, 4, 2, 6};  // grey, grey + alpha, RGB, RGBA
  std::vector<std::uint8_t> out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  std::vector<std::uint8_t> header;
  append_u32(header, static_cast<std::uint32_t>(image.width));
  append_u32(header, static_cast<std::uint32_t>(image.height));
  header.insert(header.end(), {8, colour_types[static_cast<std::size_t>(image.channels - 1)], 0, 0, 0});
  append_chunk(out, "IHDR", header);
  append_chunk(out, "sRGB", std::array<std::uint8_t, 1>{0});
  for (const auto& [keyword, text] : texts) append_text(out, keyword, text);

  auto bands = deflated_bands(image);
  static constexpr std::array<std::uint8_t, 2> zlib_header{0x78, 0x01};
  bands.front().deflated.insert(bands.front().deflated.begin(), zlib_header.begin(), zlib_header.end());
  uLong adler = 1;
  for (const Band& band : bands) adler = adler32_combine(adler, band.adler, static_cast<z_off_t>(band.filtered_bytes));
  append_u32(bands.back().deflated, static_cast<std::uint32_t>(adler));
  for (const Band& band : bands) append_chunk(out, "IDAT", band.deflated);
  append_chunk(out, "IEND", {});

  std::vector<std::byte> bytes(out.size());
  std::memcpy(bytes.data(), out.data(), out.size());
  return bytes;
}

}  // namespace penumbra
