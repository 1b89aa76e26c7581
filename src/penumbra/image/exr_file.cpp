#include "penumbra/image/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <set>
#include <stdexcept>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/image/decode_limits.h"
#include "penumbra/image/exr_header.h"
#include "penumbra/image/image_io.h"

namespace penumbra {
namespace {

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::span<const std::byte> bytes) : Imf::IStream("picture"), bytes_(bytes) {}

  bool read(char to[], int count) override {
    const auto wanted = static_cast<std::size_t>(count);
    if (count < 0 || at_ > bytes_.size() || wanted > bytes_.size() - at_) throw std::runtime_error("it ends too early");
    std::memcpy(to, bytes_.data() + at_, wanted);
    at_ += wanted;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t at_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("picture") {}

  void write(const char from[], int count) override {
    const std::size_t end = at_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + at_, from, static_cast<std::size_t>(count));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
  std::uint64_t at_ = 0;
};

// R, G, B, A lead whatever else is in the file; OpenEXR itself orders by name.
std::vector<std::string> ordered_channels(const Imf::ChannelList& list, std::string_view name) {
  std::vector<std::string> names;
  for (const char* leading : {"R", "G", "B", "A"}) {
    if (list.findChannel(leading) != nullptr) names.emplace_back(leading);
  }
  const std::set<std::string> taken(names.begin(), names.end());
  for (auto it = list.begin(); it != list.end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) {
      throw FileError(name, std::string("channel ") + it.name(), "is subsampled (luminance-chroma); save it as RGB");
    }
    if (!taken.contains(it.name())) names.emplace_back(it.name());
  }
  return names;
}

Imf::FrameBuffer frame_buffer(Image& image, int left, int top) {
  const std::size_t pixel = image.channels.size() * sizeof(float);
  const std::size_t row = pixel * static_cast<std::size_t>(image.width);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    // OpenEXR adds x * pixel + y * row to the base, with x and y counted from its own origin: integers avoid a
    // pointer outside the array.
    const auto origin = reinterpret_cast<std::intptr_t>(image.data.data() + c) -
                        static_cast<std::intptr_t>(left) * static_cast<std::intptr_t>(pixel) -
                        static_cast<std::intptr_t>(top) * static_cast<std::intptr_t>(row);
    buffer.insert(image.channels[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(origin), pixel, row));
  }
  return buffer;
}

void limit_library_once() {
  // OpenEXR checks these while it reads a header, before it allocates.
  [[maybe_unused]] static const bool done = [] {
    Imf::Header::setMaxImageSize(max_image_side, max_image_side);
    Imf::Header::setMaxTileSize(max_image_side, max_image_side);
    return true;
  }();
}

Image read_pixels(std::span<const std::byte> bytes, std::string_view name) {
  limit_library_once();
  check_exr_header(bytes, name);
  MemoryInput stream(bytes);
  Imf::InputFile file(stream);
  const Imf::Header& header = file.header();
  const auto window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  auto channels = ordered_channels(header.channels(), name);
  check_decode_limits(width, height, static_cast<std::int64_t>(channels.size()), bytes.size(), name);

  Image image(static_cast<int>(width), static_cast<int>(height), std::move(channels));
  file.setFrameBuffer(frame_buffer(image, window.min.x, window.min.y));
  file.readPixels(window.min.y, window.max.y);
  for (auto it = header.begin(); it != header.end(); ++it) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute());
    if (text != nullptr && std::string_view(it.name()) != "type") image.metadata[it.name()] = text->value();
  }
  return image;
}

Imf::Header make_header(const Image& image, Imf::PixelType type) {
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.zipCompressionLevel() = 4;
  for (const std::string& channel : image.channels) {
    if (channel.empty() || header.channels().findChannel(channel) != nullptr) {
      throw std::invalid_argument("EXR channels need names of their own; \"" + channel + "\" is empty or comes twice");
    }
    header.channels().insert(channel, Imf::Channel(type));
  }
  static const std::set<std::string> reserved{"type", "name", "view", "version", "chunkCount", "tiles"};
  for (const auto& [key, text] : image.metadata) {
    if (key.empty() || key.size() > 255 || reserved.contains(key) || header.find(key) != header.end()) {
      throw std::invalid_argument("EXR metadata cannot be called \"" + key + "\": OpenEXR keeps that name for itself");
    }
    header.insert(key, Imf::StringAttribute(text));
  }
  return header;
}

}  // namespace

Image decode_exr(std::span<const std::byte> bytes, std::string_view name) {
  try {
    return read_pixels(bytes, name);
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw FileError(
        name, "",
        std::string("cannot be decoded, its EXR data is damaged or of an unknown kind (") + error.what() + ")");
  }
}

std::vector<std::byte> encode_exr(const Image& image, ExrDepth depth) {
  MemoryOutput stream;
  if (depth == ExrDepth::half) {
    constexpr float largest_half = 65504;
    std::vector<half> narrow;
    narrow.reserve(image.data.size());
    for (const float x : image.data) narrow.emplace_back(std::clamp(x, -largest_half, largest_half));
    Imf::OutputFile file(stream, make_header(image, Imf::HALF), 0);
    Imf::FrameBuffer buffer;
    const std::size_t pixel = image.channels.size() * sizeof(half);
    for (std::size_t c = 0; c < image.channels.size(); ++c) {
      buffer.insert(image.channels[c], Imf::Slice(Imf::HALF, reinterpret_cast<char*>(narrow.data() + c), pixel,
                                                  pixel * static_cast<std::size_t>(image.width)));
    }
    file.setFrameBuffer(buffer);
    file.writePixels(image.height);
  } else {
    Imf::OutputFile file(stream, make_header(image, Imf::FLOAT), 0);
    Image& source = const_cast<Image&>(image);  // Imf::Slice is for reading and writing alike
    file.setFrameBuffer(frame_buffer(source, 0, 0));
    file.writePixels(image.height);
  }
  return stream.take();
}

}  // namespace penumbra
