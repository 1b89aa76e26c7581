#include "penumbra/image/image_io.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/image/exr_file.h"
#include "penumbra/image/tonemap.h"
#include "penumbra/math/rng.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

/// A folder of this test alone, gone afterwards.
class ImageIo : public testing::Test {
 protected:
  ImageIo()
      : folder_(std::filesystem::temp_directory_path() /
                ("penumbra-image-io-" + std::to_string(::getpid()) + "-" +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~ImageIo() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write_bytes(const char* name, std::span<const std::byte> bytes) const {
    const auto path = folder_ / name;
    std::filesystem::remove(path);  // some file systems wait for the disk when a file is cut and rewritten
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

  std::filesystem::path folder_;
};

Image8 noise8(int width, int height, int channels, std::uint64_t seed) {
  Image8 image{width, height, channels, {}};
  image.data.resize(static_cast<std::size_t>(width * height * channels));
  CounterRng rng(seed);
  for (auto& v : image.data) v = static_cast<std::uint8_t>(rng.next_bits());
  return image;
}

/// Radiances over twelve powers of two, as a picture of a lamp and its shadows holds them.
Image radiances(int width, int height, std::vector<std::string> channels = {"R", "G", "B"}) {
  Image image(width, height, std::move(channels));
  CounterRng rng(7);
  for (auto& v : image.data) v = static_cast<float>(std::exp2(12 * rng.next() - 6));
  return image;
}

std::uint32_t u32_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t v = 0;
  for (std::size_t i = 0; i < 4; ++i) v = v << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  return v;
}

/// CRC-32 of the PNG standard, annex D, bit by bit: nothing of zlib's.
std::uint32_t crc_of(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xffffffffU;
  for (const std::byte b : bytes) {
    crc ^= std::to_integer<std::uint32_t>(b);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? 0xedb88320U ^ (crc >> 1) : crc >> 1;
  }
  return ~crc;
}

void expect_file_error(const std::filesystem::path& path, std::string_view part) {
  try {
    static_cast<void>(read_image(path));
    ADD_FAILURE() << path << " was read";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST_F(ImageIo, AnotherDecoderReadsOurPngBitExactly) {
  for (int channels = 1; channels <= 4; ++channels) {
    for (const auto& [width, height] : {std::array{1, 1}, {1, 300}, {317, 1}, {33, 17}, {700, 500}}) {
      const Image8 image = noise8(width, height, channels, 3);
      const Image8 back = decode_image8(encode_png(image), "noise.png");  // stb_image: its own inflate, not zlib
      EXPECT_EQ(back.width, width);
      EXPECT_EQ(back.height, height);
      EXPECT_EQ(back.channels, channels);
      EXPECT_EQ(back.data, image.data) << width << " x " << height << " x " << channels;
    }
  }
}

TEST_F(ImageIo, PngChunksAreInOrderAndTheirChecksumsHold) {
  const auto png = encode_png(noise8(400, 300, 3, 5));  // more than one band
  std::size_t at = 8;
  std::string types;
  while (at + 12 <= png.size()) {
    const std::size_t length = u32_at(png, at);
    ASSERT_LE(at + 12 + length, png.size());
    const auto checked = std::span(png).subspan(at + 4, length + 4);
    EXPECT_EQ(u32_at(png, at + 8 + length), crc_of(checked));
    types += std::string(reinterpret_cast<const char*>(checked.data()), 4) + " ";
    at += 12 + length;
  }
  EXPECT_EQ(at, png.size());
  EXPECT_EQ(types, "IHDR sRGB IDAT IDAT IEND ");
}

TEST_F(ImageIo, PngBytesDoNotDependOnThreadsThreaded) {
  const Image8 image = noise8(900, 700, 3, 9);
  const auto alone = [&] {
    const ThreadLimit limit(1);
    return encode_png(image);
  }();
  const ThreadLimit limit(8);
  EXPECT_EQ(encode_png(image), alone);
}

TEST_F(ImageIo, PngRefusesAPictureThatIsNotWhole) {
  EXPECT_THROW(static_cast<void>(encode_png({2, 2, 3, {1, 2, 3}})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(encode_png({1, 1, 5, {1, 2, 3, 4, 5}})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(encode_png({0, 1, 1, {}})), std::invalid_argument);
}

TEST_F(ImageIo, PngHoldsTheNearestSrgbCode) {
  Image image(6, 1);
  image.set_rgb(0, 0, Rgb(0.5F));   // encodes to 0.735357, times 255 is 187.5160
  image.set_rgb(1, 0, Rgb(7.0F));   // clamped
  image.set_rgb(2, 0, Rgb(-1.0F));  // clamped
  image.set_rgb(3, 0, Rgb(NAN));    // black
  image.set_rgb(4, 0, Rgb(INFINITY));
  image.set_rgb(5, 0, {0.18F, 0.001F, 0.9F});  // 0.461356, 0.01292, 0.954687
  write_image(folder_ / "a.PNG", image);
  const Image8 back = decode_image8(read_file(folder_ / "a.PNG"), "a.PNG");
  const std::vector<std::uint8_t> expected{188, 188, 188, 255, 255, 255, 0, 0, 0, 0, 0, 0, 255, 255, 255, 118, 3, 243};
  EXPECT_EQ(back.data, expected);
}

TEST_F(ImageIo, PngThereAndBackStaysWithinHalfACode) {
  const Image image = [] {
    Image out(64, 64, {"R", "G", "B", "A"});
    CounterRng rng(2);
    for (auto& v : out.data) v = static_cast<float>(rng.next());
    return out;
  }();
  write_image(folder_ / "a.png", image);
  const Image back = read_image(folder_ / "a.png");
  ASSERT_EQ(back.channels, image.channels);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    const bool alpha = i % 4 == 3;
    const float a = alpha ? image.data[i] : srgb_encode(image.data[i]);
    const float b = alpha ? back.data[i] : srgb_encode(back.data[i]);
    EXPECT_NEAR(a, b, 0.5F / 255 + 1e-5F);
  }
}

TEST_F(ImageIo, GreyPngHasOneChannel) {
  write_image(folder_ / "a.png", Image(3, 2, {"Y"}));
  EXPECT_EQ(read_image(folder_ / "a.png").channels, std::vector<std::string>{"Y"});
  write_image(folder_ / "b.png", Image(3, 2, {"Y", "A"}));
  EXPECT_EQ(read_image(folder_ / "b.png").channels, (std::vector<std::string>{"Y", "A"}));
}

TEST_F(ImageIo, ExrThereAndBackIsExact) {
  Image image = radiances(37, 23, {"R", "G", "B", "A", "depth.Z", "albedo.R"});
  image.data[0] = std::numeric_limits<float>::infinity();
  image.data[1] = -0.0F;
  image.data[2] = std::numeric_limits<float>::denorm_min();
  image.metadata = {{"samples", "64"}, {"renderer", "penumbra"}, {"a key longer than thirty-one characters", "yes"}};
  write_image(folder_ / "a.exr", image);
  const Image back = read_image(folder_ / "a.exr");
  EXPECT_EQ(back.width, image.width);
  EXPECT_EQ(back.height, image.height);
  EXPECT_EQ(back.metadata, image.metadata);
  ASSERT_EQ(back.channels, (std::vector<std::string>{"R", "G", "B", "A", "albedo.R", "depth.Z"}));
  const std::array<std::size_t, 6> source{0, 1, 2, 3, 5, 4};
  for (std::size_t i = 0; i < back.data.size(); ++i) {
    const float expected = image.data[i / 6 * 6 + source[i % 6]];
    EXPECT_EQ(std::memcmp(&back.data[i], &expected, sizeof(float)), 0) << i;
  }
}

TEST_F(ImageIo, ExrRefusesNamesThatOpenExrKeepsForItself) {
  Image image(2, 2);
  image.metadata["compression"] = "none";
  EXPECT_THROW(write_image(folder_ / "a.exr", image), std::invalid_argument);
  image.metadata = {{"type", "x"}};
  EXPECT_THROW(write_image(folder_ / "a.exr", image), std::invalid_argument);
  EXPECT_THROW(write_image(folder_ / "a.exr", Image(2, 2, {"R", "R", "B"})), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(ImageIo, HdrThereAndBackStaysWithinItsMantissa) {
  for (const int width : {3, 8, 300}) {  // flat, the shortest that is run-length coded, long runs
    Image image = radiances(width, 19);
    for (int x = 0; x < width; ++x) image.set_rgb(x, 4, {1, 2, 3});
    write_image(folder_ / "a.hdr", image);
    const Image back = read_image(folder_ / "a.hdr");
    ASSERT_EQ(back.width, width);
    ASSERT_EQ(back.height, 19);
    for (int y = 0; y < 19; ++y) {
      for (int x = 0; x < width; ++x) {
        const Rgb a = image.rgb(x, y);
        const Rgb b = back.rgb(x, y);
        for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(a[c] - b[c]), max_component(a) / 256 * 1.0001F);
      }
    }
  }
}

TEST_F(ImageIo, HdrHoldsPowersOfTwoExactly) {
  Image image(8, 1);
  for (int x = 0; x < 8; ++x) image.set_rgb(x, 0, Rgb(std::exp2(static_cast<float>(10 * x - 40))));
  image.set_rgb(7, 0, {-1.0F, NAN, 255.9F / 256});  // the last rounds up into the next exponent
  write_image(folder_ / "a.hdr", image);
  const Image back = read_image(folder_ / "a.hdr");
  for (int x = 0; x < 7; ++x) EXPECT_EQ(back.rgb(x, 0), image.rgb(x, 0)) << x;
  EXPECT_EQ(back.rgb(7, 0), Rgb(0, 0, 1));
}

TEST_F(ImageIo, AnotherExtensionIsRefusedWithTheKnownOnes) {
  for (const char* name : {"a.bmp", "a", "a.png.txt"}) {
    try {
      write_image(folder_ / name, Image(2, 2));
      ADD_FAILURE() << name;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(".png, .exr or .hdr"), std::string::npos) << error.what();
    }
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(ImageIo, AMissingFolderIsNamed) {
  try {
    write_image(folder_ / "none" / "a.png", Image(2, 2));
    ADD_FAILURE();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("there is no folder " + (folder_ / "none").string()), std::string::npos)
        << error.what();
  }
}

TEST_F(ImageIo, WhatIsNoPictureIsRefused) {
  expect_file_error(folder_ / "none.png", "no such file");
  expect_file_error(folder_, "is a directory");
  expect_file_error(write_bytes("empty.png", {}), "is not a PNG, HDR or EXR picture");
  const std::string text = "a letter, not a picture";
  expect_file_error(write_bytes("text.exr", std::as_bytes(std::span(text))), "is not a PNG, HDR or EXR picture");
  EXPECT_THROW(static_cast<void>(decode_image8(std::as_bytes(std::span(text)), "t")), FileError);
}

// A header can ask for more than any memory holds: it is judged before anything is allocated.
TEST_F(ImageIo, HugeDimensionsAreRefusedBeforeTheyAreAllocated) {
  auto png = encode_png(noise8(4, 4, 3, 1));
  for (std::size_t i = 0; i < 2; ++i) png[16 + 4 * i + 2] = std::byte{0x7f};  // 32516 x 32516
  const auto crc = crc_of(std::span(png).subspan(12, 17));
  for (std::size_t i = 0; i < 4; ++i) png[29 + i] = static_cast<std::byte>(crc >> (24 - 8 * i));
  expect_file_error(write_bytes("huge.png", png), "that are read");

  const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n";
  expect_file_error(write_bytes("huge.hdr", std::as_bytes(std::span(hdr))), "");
  const std::string wide = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10000 +X 10000\n";
  expect_file_error(write_bytes("wide.hdr", std::as_bytes(std::span(wide))), "too many for its");
}

// What a JPEG claims of its Huffman tables, in whatever place a decoder may look for them.
TEST_F(ImageIo, HuffmanTablesOfMoreCodesThanThereAreAreRefused) {
  const std::string begin = "\xff\xd8";
  const std::string full(16, '\xff'), empty(16, '\0');
  const std::string comment("\xff\xfe\x00\x06\xff\xc4\x00\x13", 8);  // looks like tables, but is a comment
  const auto tables = [](const std::string& what) {
    return std::string("\xff\xc4") + '\0' + static_cast<char>(2 + what.size()) + what;
  };
  const std::string scan("\xff\xda\x00\x02\x12\xff\x00\x34\xff\xd0\x56", 11);
  const auto refusal = [](const std::string& jpeg) {
    try {
      (void)decode_image8(std::as_bytes(std::span(jpeg)), "a.jpg");
    } catch (const FileError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const std::string& jpeg :
       {begin + tables('\0' + full), begin + tables('\0' + empty + '\0' + full), begin + scan + tables('\0' + full),
        begin + tables('\0' + empty + '\0') + full, begin + comment + tables('\0' + full.substr(0, 3))}) {
    EXPECT_NE(refusal(jpeg).find("256 codes"), std::string::npos) << refusal(jpeg);
  }
  EXPECT_EQ(refusal(begin + comment + full + tables('\0' + empty)).find("256 codes"), std::string::npos);
}

// OpenEXR takes the memory that an attribute claims, or that it takes for one when the length before was wrong.
TEST_F(ImageIo, AttributesThatReachBeyondTheirFileAreRefused) {
  const std::vector<std::byte> whole = encode_exr(radiances(4, 3));
  const std::string text(reinterpret_cast<const char*>(whole.data()), whole.size());
  const auto refused = [&](const std::string& damaged, const char* part) {
    expect_file_error(write_bytes("a.exr", std::as_bytes(std::span(damaged))), part);
  };
  const auto with_length = [&](std::string_view type, const std::string& length) {
    std::string damaged = text;
    damaged.replace(damaged.find(std::string(type) + '\0') + type.size() + 1, 4, length);
    return damaged;
  };
  refused(with_length("chlist", std::string("\xff\xff\xff\x7f", 4)), "beyond the file's end");
  refused(with_length("chlist", std::string("\x01\0\0\0", 4)), "not as long as its type asks");
  refused(with_length("box2i", std::string("\x11\0\0\0", 4)), "not as long as its type asks");
}

// Any damage either decodes (to something) or is a FileError: nothing else, and no crash under the sanitizers.
class DamagedPicture : public ImageIo, public testing::WithParamInterface<const char*> {};

TEST_P(DamagedPicture, LoadsOrIsAFileError) {
  const auto path = folder_ / (std::string("whole.") + GetParam());
  write_image(path, radiances(40, 30));
  const auto whole = read_file(path);
  CounterRng rng(11);
  int refused = 0;
  const int trials = 300;
  for (int trial = 0; trial < trials; ++trial) {
    auto bytes = whole;
    if (trial % 2 == 0) {
      bytes.resize(static_cast<std::size_t>(rng.next() * static_cast<double>(whole.size())));
    } else {
      // Headers are short: half of the damage goes to the first 400 bytes.
      const std::size_t reach = trial % 4 == 1 ? std::min<std::size_t>(400, bytes.size()) : bytes.size();
      for (int n = 0; n < 1 + trial % 7; ++n) {
        bytes[static_cast<std::size_t>(rng.next() * static_cast<double>(reach))] =
            static_cast<std::byte>(rng.next_bits());
      }
    }
    try {
      const Image image = read_image(write_bytes("damaged", bytes));
      EXPECT_EQ(image.data.size(), image.index(0, image.height));
    } catch (const FileError& error) {
      ++refused;
      EXPECT_EQ(error.path(), (folder_ / "damaged").string());
    }
  }
  EXPECT_GT(refused, trials / 4);  // truncations at least
}

INSTANTIATE_TEST_SUITE_P(, DamagedPicture, testing::Values("png", "exr", "hdr"));

}  // namespace
}  // namespace penumbra
