#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <random>

#include "io/gltf_builder.h"
#include "penumbra/file/file_error.h"
#include "penumbra/io/meshopt_view.h"

namespace penumbra::test {
namespace {

std::string packed_vertices(const std::string& plain, std::size_t count, std::size_t stride) {
  std::string packed(meshopt_encodeVertexBufferBound(count, stride), '\0');
  packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(), plain.data(),
                                           count, stride));
  return packed;
}

std::string packed_triangles(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  std::string packed(meshopt_encodeIndexBufferBound(indices.size(), vertices), '\0');
  packed.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                          indices.data(), indices.size()));
  return packed;
}

/// A view whose bytes are `content`, packed, in a fallback buffer of its own that is not there.
std::size_t add_packed_view(GltfBuilder& builder, const std::string& content, const char* mode, std::size_t count,
                            std::size_t stride, const char* filter = "NONE") {
  const auto view = builder.add_view(content);
  nlohmann::json& json = builder.json["bufferViews"][view];
  json["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                   {"byteOffset", json["byteOffset"]},
                                                   {"byteLength", content.size()},
                                                   {"mode", mode},
                                                   {"count", count},
                                                   {"byteStride", stride},
                                                   {"filter", filter}};
  json["buffer"] = 1;
  json["byteOffset"] = 0;
  json["byteLength"] = count * stride;
  return view;
}

TEST(Meshopt, ACubeComesOutAsItWentIn) {
  GltfBuilder builder;
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  const auto vertices =
      add_packed_view(builder, packed_vertices(GltfBuilder::packed(cube_positions), 8, 12), "ATTRIBUTES", 8, 12);
  const auto triangles = add_packed_view(builder, packed_triangles(cube_indices, 8), "TRIANGLES", 36, 4);
  const auto positions = builder.add(
      "accessors", {{"bufferView", vertices}, {"componentType", gltf_float}, {"count", 8}, {"type", "VEC3"}});
  const auto indices = builder.add(
      "accessors", {{"bufferView", triangles}, {"componentType", gltf_uint32}, {"count", 36}, {"type", "SCALAR"}});
  builder.show({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const LoadedScene loaded = builder.read();
  EXPECT_TRUE(loaded.warnings.empty());
  const Extent extent = extent_of(loaded.scene);
  EXPECT_NEAR(extent.area, 6, 1e-12);
  EXPECT_NEAR(extent.volume, 1, 1e-12);
}

TEST(Meshopt, EveryModeAndFilterIsUndone) {
  const std::vector<std::uint32_t> indices = {5, 1, 0, 7, 7, 2, 100, 3};
  std::string packed(meshopt_encodeIndexSequenceBound(indices.size(), 101), '\0');
  packed.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                            indices.data(), indices.size()));
  const auto bytes_of = [](const std::string& text) { return std::as_bytes(std::span(text.data(), text.size())); };
  const auto sequence = decode_meshopt(bytes_of(packed), {.mode = "INDICES", .count = 8, .stride = 4});
  EXPECT_TRUE(std::ranges::equal(sequence, bytes_of(GltfBuilder::packed(indices))));

  const std::vector<float> numbers = {1, -0.25F, 1000, 0.001F};
  std::string filtered(16, '\0');
  meshopt_encodeFilterExp(filtered.data(), 4, 4, 20, numbers.data());
  const auto back = decode_meshopt(bytes_of(packed_vertices(filtered, 4, 4)),
                                   {.mode = "ATTRIBUTES", .filter = "EXPONENTIAL", .count = 4, .stride = 4});
  for (std::size_t i = 0; i < 4; ++i) {
    float value = 0;
    std::memcpy(&value, back.data() + 4 * i, 4);
    EXPECT_NEAR(value, numbers[i], 1e-5F * std::abs(numbers[i]));
  }

  const std::vector<float> normals = {0.6F, 0, 0.8F, 1, 0, -1, 0, 1};
  std::string octahedral(16, '\0');
  meshopt_encodeFilterOct(octahedral.data(), 2, 8, 16, normals.data());
  const auto turned = decode_meshopt(bytes_of(packed_vertices(octahedral, 2, 8)),
                                     {.mode = "ATTRIBUTES", .filter = "OCTAHEDRAL", .count = 2, .stride = 8});
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      std::int16_t value = 0;
      std::memcpy(&value, turned.data() + 8 * i + 2 * c, 2);
      EXPECT_NEAR(value / 32767.0, static_cast<double>(normals[4 * i + c]), 1e-3);
    }
  }
}

// Nothing that a file says may crash the reader or take memory that its bytes cannot fill.
TEST(Meshopt, DamagedDataAreRefused) {
  const std::string good = packed_vertices(GltfBuilder::packed(cube_positions), 8, 12);
  const auto refused = [](const std::string& text, const MeshoptPacking& packing) {
    EXPECT_THROW((void)decode_meshopt(std::as_bytes(std::span(text.data(), text.size())), packing),
                 std::invalid_argument)
        << packing.mode << packing.count;
  };
  const MeshoptPacking right{.mode = "ATTRIBUTES", .count = 8, .stride = 12};
  refused("", right);
  refused(good.substr(0, good.size() - 5), right);
  refused(good, {.mode = "ATTRIBUTES", .count = std::size_t{1} << 31, .stride = 12});
  refused(good, {.mode = "ATTRIBUTES", .count = ~std::size_t{0} / 12, .stride = 12});
  refused(good, {.mode = "TRIANGLES", .count = std::size_t{3} << 30, .stride = 4});
  refused(good, {.mode = "ATTRIBUTES", .count = 8, .stride = 10});
  refused(good, {.mode = "ATTRIBUTES", .count = 8, .stride = 0});
  refused(good, {.mode = "ATTRIBUTES", .count = 8, .stride = 4096});
  refused(good, {.mode = "SPRITES", .count = 8, .stride = 12});
  refused(good, {.mode = "ATTRIBUTES", .filter = "OCTAHEDRAL", .count = 8, .stride = 12});
  std::mt19937 random(3);
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = good;
    damaged[random() % damaged.size()] = static_cast<char>(random());
    try {
      EXPECT_EQ(decode_meshopt(std::as_bytes(std::span(damaged.data(), damaged.size())), right).size(), 96U);
    } catch (const std::invalid_argument&) {
    }
  }
}

TEST(Basisu, IsNamedInTheRefusal) {
  GltfBuilder builder;
  builder.json["extensionsRequired"] = {"KHR_texture_basisu"};
  try {
    (void)builder.read();
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("convert them to PNG"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace penumbra::test
