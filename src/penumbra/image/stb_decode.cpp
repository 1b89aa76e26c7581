#include "penumbra/image/stb_decode.h"

#include <cstdlib>
#include <limits>
#include <memory>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/image/decode_limits.h"
#include "penumbra/image/jpeg_tables.h"
#include "penumbra/image/tonemap.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 32768
// Zeroed: a JPEG may name tables that it never gives, and stb reads them all the same.
#define STBI_MALLOC(size) std::calloc(1, size)
#define STBI_REALLOC(memory, size) std::realloc(memory, size)
#define STBI_FREE(memory) std::free(memory)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wold-style-cast"  // around the macros above
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace penumbra {
namespace {

static_assert(STBI_MAX_DIMENSIONS == max_image_side);

template <class Sample>
struct StbFree {
  void operator()(Sample* samples) const { stbi_image_free(samples); }
};
template <class Sample>
using StbSamples = std::unique_ptr<Sample, StbFree<Sample>>;

/// The bytes as stb takes them, dimensions already checked.
struct StbSource {
  const stbi_uc* data;
  int size;
  int width = 0;
  int height = 0;
  int channels = 0;
};

[[noreturn]] void fail(std::string_view name) {
  const char* reason = stbi_failure_reason();
  throw FileError(name, "",
                  std::string("cannot be decoded, it is damaged or cut short (") + (reason ? reason : "?") + ")");
}

std::int64_t png_number(std::span<const std::byte> bytes, std::size_t at) {
  std::int64_t v = 0;
  for (std::size_t i = 0; i < 4; ++i) v = v << 8 | std::to_integer<std::int64_t>(bytes[at + i]);
  return v;
}

// stb calls a PNG that is too large an unknown image type; the reader deserves better.
void check_png_header(std::span<const std::byte> bytes, std::string_view name) {
  constexpr std::size_t size_at = 16;
  if (bytes.size() < size_at + 8) throw FileError(name, "", "is cut short within its PNG header");
  check_decode_limits(png_number(bytes, size_at), png_number(bytes, size_at + 4), 1, bytes.size(), name);
}

// stb takes memory for whatever length a chunk claims.
void check_png_chunks(std::span<const std::byte> bytes, std::string_view name) {
  constexpr std::size_t signature = 8, frame = 12;  // length, type and checksum
  constexpr std::int64_t end = 0x49454E44;
  for (std::size_t at = signature; at + frame <= bytes.size();) {
    const auto length = static_cast<std::size_t>(png_number(bytes, at));
    if (png_number(bytes, at + 4) == end) return;
    if (length > bytes.size() - at - frame) {
      throw FileError(name, "", "cannot be decoded, a chunk reaches beyond the file's end: it is damaged or cut short");
    }
    at += frame + length;
  }
}

StbSource checked_source(std::span<const std::byte> bytes, std::string_view name) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw FileError(name, "", "is larger than 2 GiB, the most that is decoded");
  }
  StbSource source{reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size())};
  if (bytes.front() == std::byte{0x89}) {
    check_png_header(bytes, name);
    check_png_chunks(bytes, name);
  } else {
    check_jpeg_tables(bytes, name);
  }
  if (stbi_info_from_memory(source.data, source.size, &source.width, &source.height, &source.channels) == 0) fail(name);
  check_decode_limits(source.width, source.height, source.channels, bytes.size(), name);
  return source;
}

std::size_t sample_count(const StbSource& source) {
  return static_cast<std::size_t>(source.width) * static_cast<std::size_t>(source.height) *
         static_cast<std::size_t>(source.channels);
}

std::vector<std::string> channel_names(int count) {
  switch (count) {
    case 1:
      return {"Y"};
    case 2:
      return {"Y", "A"};
    case 3:
      return {"R", "G", "B"};
    default:
      return {"R", "G", "B", "A"};
  }
}

// Decodes one sRGB picture with `decode[value]`, the linear value of each integer sample.
template <class Sample>
Image linear_image(const StbSource& source, const Sample* samples, const std::vector<float>& decode) {
  Image image(source.width, source.height, channel_names(source.channels));
  const bool has_alpha = source.channels == 2 || source.channels == 4;
  const auto channels = static_cast<std::size_t>(source.channels);
  const auto largest = static_cast<float>(std::numeric_limits<Sample>::max());
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    const bool is_alpha = has_alpha && i % channels == channels - 1;
    image.data[i] = is_alpha ? static_cast<float>(samples[i]) / largest : decode[samples[i]];
  }
  return image;
}

template <class Sample>
std::vector<float> srgb_table() {
  constexpr std::size_t largest = std::numeric_limits<Sample>::max();
  std::vector<float> table(largest + 1);
  for (std::size_t i = 0; i <= largest; ++i)
    table[i] = srgb_decode(static_cast<float>(i) / static_cast<float>(largest));
  return table;
}

// stb calls a picture damaged when memory runs out within it. About what it will take is asked for here first: its own
// two copies, and ours.
void check_memory(const StbSource& source, std::size_t sample) {
  ::operator delete(::operator new(3 * sample * sample_count(source)));
}

}  // namespace

Image8 decode_png_or_jpeg(std::span<const std::byte> bytes, std::string_view name) {
  StbSource source = checked_source(bytes, name);
  check_memory(source, sizeof(stbi_uc));
  const StbSamples<stbi_uc> samples(
      stbi_load_from_memory(source.data, source.size, &source.width, &source.height, &source.channels, 0));
  if (!samples) fail(name);
  return {source.width, source.height, source.channels, {samples.get(), samples.get() + sample_count(source)}};
}

Image decode_png_to_linear(std::span<const std::byte> bytes, std::string_view name) {
  StbSource source = checked_source(bytes, name);
  check_memory(source, sizeof(stbi_us));
  if (stbi_is_16_bit_from_memory(source.data, source.size) != 0) {
    const StbSamples<stbi_us> samples(
        stbi_load_16_from_memory(source.data, source.size, &source.width, &source.height, &source.channels, 0));
    if (!samples) fail(name);
    return linear_image(source, samples.get(), srgb_table<stbi_us>());
  }
  const StbSamples<stbi_uc> samples(
      stbi_load_from_memory(source.data, source.size, &source.width, &source.height, &source.channels, 0));
  if (!samples) fail(name);
  return linear_image(source, samples.get(), srgb_table<stbi_uc>());
}

}  // namespace penumbra
