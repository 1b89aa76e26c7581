#include "penumbra/io/gltf_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "io/gltf_builder.h"
#include "penumbra/file/file_error.h"

namespace penumbra::test {
namespace {

template <class T>
std::vector<T> converted(const std::vector<std::uint32_t>& values) {
  return {values.begin(), values.end()};
}

/// The triangles as sets of corner positions that start with the least corner: equal for equal surfaces with equal
/// fronts.
std::multiset<std::vector<double>> surface_of(const Scene& scene) {
  std::multiset<std::vector<double>> surface;
  for (const Mesh& mesh : scene.meshes) {
    for (auto t : mesh.triangles) {
      std::vector<std::vector<double>> corners;
      for (const auto corner : t) {
        const Vec3d& p = mesh.positions[corner];
        corners.push_back({p.x, p.y, p.z});
      }
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      std::vector<double> flat;
      for (const auto& c : corners) flat.insert(flat.end(), c.begin(), c.end());
      surface.insert(flat);
    }
  }
  return surface;
}

LoadedScene read_text(const nlohmann::json& json, std::string_view extension = ".gltf") {
  const TemporaryFile file(json.dump(), std::string(extension));
  return read_gltf(file.path());
}

TEST(GltfReader, EveryIndexTypeGivesTheUnitCube) {
  for (const int type : {gltf_uint8, gltf_uint16, gltf_uint32, 0}) {
    GltfBuilder builder;
    nlohmann::json primitive = {
        {"attributes", {{"POSITION", builder.add_accessor(cube_positions, "VEC3", gltf_float)}}}};
    if (type == gltf_uint8)
      primitive["indices"] = builder.add_accessor(converted<std::uint8_t>(cube_indices), "SCALAR", type);
    if (type == gltf_uint16)
      primitive["indices"] = builder.add_accessor(converted<std::uint16_t>(cube_indices), "SCALAR", type);
    if (type == gltf_uint32) primitive["indices"] = builder.add_accessor(cube_indices, "SCALAR", type);
    if (type == 0) {  // no indices: every corner written out
      std::vector<float> corners;
      for (const auto i : cube_indices)
        corners.insert(corners.end(), &cube_positions[3 * i], &cube_positions[3 * i] + 3);
      primitive["attributes"]["POSITION"] = builder.add_accessor(corners, "VEC3", gltf_float);
    }
    builder.show(primitive);
    const auto loaded = builder.read();
    ASSERT_EQ(loaded.scene.triangle_count(), 12U) << type;
    EXPECT_EQ(loaded.scene.meshes[0].positions.size(), type == 0 ? 36U : 8U);
    EXPECT_DOUBLE_EQ(extent_of(loaded.scene).area, 6) << type;
    EXPECT_DOUBLE_EQ(extent_of(loaded.scene).volume, 1) << type;
    EXPECT_TRUE(loaded.warnings.empty());
    EXPECT_TRUE(loaded.scene.meshes[0].normals.empty());
  }
}

TEST(GltfReader, StripsAndFansEqualTheirTriangles) {
  // A fan around the corner of a bent sheet, and the same sheet as a strip.
  const std::vector<float> points = {0, 0, 0, 2, 0, 0, 2, 1, 0.5, 1, 2, 1, 0, 2, 0};
  const std::vector<std::uint8_t> fan = {0, 1, 2, 3, 4};
  const std::vector<std::uint8_t> fan_triangles = {1, 2, 0, 2, 3, 0, 3, 4, 0};
  const std::vector<std::uint8_t> strip = {1, 2, 0, 3, 4};
  const std::vector<std::uint8_t> strip_triangles = {1, 2, 0, 2, 3, 0, 0, 3, 4};
  const auto scene = [&](const std::vector<std::uint8_t>& indices, int mode) {
    GltfBuilder builder;
    builder.show({{"attributes", {{"POSITION", builder.add_accessor(points, "VEC3", gltf_float)}}},
                  {"indices", builder.add_accessor(indices, "SCALAR", gltf_uint8)},
                  {"mode", mode}});
    return builder.read().scene;
  };
  EXPECT_EQ(surface_of(scene(fan, 6)), surface_of(scene(fan_triangles, 4)));
  EXPECT_EQ(surface_of(scene(strip, 5)), surface_of(scene(strip_triangles, 4)));
  EXPECT_NEAR(extent_of(scene(strip, 5)).area, extent_of(scene(fan, 6)).area, 1e-15);
}

TEST(GltfReader, RepeatedCornersOfAStripAreNoSurface) {
  GltfBuilder builder;
  builder.show({{"attributes", {{"POSITION", builder.add_accessor(cube_positions, "VEC3", gltf_float)}}},
                {"indices", builder.add_accessor<std::uint8_t>({0, 2, 1, 3, 3, 4, 4, 5, 6, 7}, "SCALAR", gltf_uint8)},
                {"mode", 5}});
  const auto loaded = builder.read();
  EXPECT_DOUBLE_EQ(extent_of(loaded.scene).area, 2);
  EXPECT_EQ(loaded.scene.triangle_count(), 4U);
  EXPECT_TRUE(loaded.warnings.empty());
}

TEST(GltfReader, NormalisedIntegersDecodeByTheRule) {
  // glTF 2.0, section 3.11: max(c / 127, -1), c / 255, max(c / 32767, -1), c / 65535.
  const auto positions = [](auto values, int type) {
    GltfBuilder builder;
    builder.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    builder.show({{"attributes", {{"POSITION", builder.add_accessor(values, "VEC3", type, true)}}}});
    return builder.read().scene.meshes[0].positions;
  };
  const auto signed_8 = positions(std::vector<std::int8_t>{-128, -127, 0, 127, 1, 64, 5, 6, 7}, gltf_int8);
  EXPECT_EQ(signed_8[0], Vec3d(-1, -1, 0));
  EXPECT_EQ(signed_8[1], Vec3d(1, 1.0 / 127, 64.0 / 127));
  const auto unsigned_8 = positions(std::vector<std::uint8_t>{0, 51, 255, 1, 2, 3, 9, 7, 5}, gltf_uint8);
  EXPECT_EQ(unsigned_8[0], Vec3d(0, 0.2, 1));
  const auto signed_16 = positions(std::vector<std::int16_t>{-32768, -32767, 32767, 1, 2, 3, 4, 9, 6}, gltf_int16);
  EXPECT_EQ(signed_16[0], Vec3d(-1, -1, 1));
  const auto unsigned_16 = positions(std::vector<std::uint16_t>{0, 13107, 65535, 1, 2, 3, 4, 9, 6}, gltf_uint16);
  EXPECT_EQ(unsigned_16[0], Vec3d(0, 0.2, 1));
}

TEST(GltfReader, PlainIntegersStayAsTheyAre) {
  GltfBuilder builder;
  builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  builder.show(
      {{"attributes",
        {{"POSITION", builder.add_accessor<std::int16_t>({-300, 0, 7, 1, 2, 3, 4, 9, 6}, "VEC3", gltf_int16)}}}});
  EXPECT_EQ(builder.read().scene.meshes[0].positions[0], Vec3d(-300, 0, 7));
}

TEST(GltfReader, StridesAndOffsetsInterleaveAttributes) {
  // Position and normal of each vertex side by side, after 8 bytes that belong to nobody.
  std::vector<float> mixed = {-1, -1};
  for (std::size_t v = 0; v < 8; ++v) {
    mixed.insert(mixed.end(), &cube_positions[3 * v], &cube_positions[3 * v] + 3);
    mixed.insert(mixed.end(), {0, 3, 4});
  }
  GltfBuilder builder;
  const auto view = builder.add_view(GltfBuilder::packed(mixed), 24);
  const auto part = [&](int offset) {
    return builder.add(
        "accessors",
        {{"bufferView", view}, {"byteOffset", offset}, {"componentType", gltf_float}, {"count", 8}, {"type", "VEC3"}});
  };
  const auto position = part(8);
  const auto normal = part(20);
  builder.show({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
                {"indices", builder.add_accessor(cube_indices, "SCALAR", gltf_uint32)}});
  const auto scene = builder.read().scene;
  EXPECT_DOUBLE_EQ(extent_of(scene).volume, 1);
  for (const Vec3f& n : scene.meshes[0].normals) EXPECT_EQ(n, Vec3f(0, 0.6F, 0.8F));
}

TEST(GltfReader, SparseElementsReplaceTheirs) {
  for (const bool from_zeros : {false, true}) {
    GltfBuilder builder;
    nlohmann::json accessor = {{"componentType", gltf_float}, {"count", 3}, {"type", "VEC3"}};
    if (!from_zeros) accessor["bufferView"] = builder.add_view(GltfBuilder::packed<float>({9, 9, 9, 1, 0, 0, 9, 9, 9}));
    accessor["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", builder.add_view(std::string("\0\2", 2))}, {"componentType", gltf_uint8}}},
        {"values", {{"bufferView", builder.add_view(GltfBuilder::packed<float>({0, 5, 0, 0, 0, 7}))}}}};
    builder.show({{"attributes", {{"POSITION", builder.add("accessors", accessor)}}}});
    const auto positions = builder.read().scene.meshes[0].positions;
    EXPECT_EQ(positions[0], Vec3d(0, 5, 0));
    EXPECT_EQ(positions[1], from_zeros ? Vec3d(0) : Vec3d(1, 0, 0));
    EXPECT_EQ(positions[2], Vec3d(0, 0, 7));
  }
}

TEST(GltfReader, TransformsComposeFromRootToLeaf) {
  GltfBuilder builder;
  builder.show({{"attributes", {{"POSITION", builder.add_accessor(cube_positions, "VEC3", gltf_float)}}},
                {"indices", builder.add_accessor(cube_indices, "SCALAR", gltf_uint32)}});
  const double half = std::sqrt(0.5);
  // A quarter turn about y takes x to -z; then the parent shears nothing but moves and doubles.
  builder.json["nodes"] = {
      {{"name", "root"}, {"translation", {10, 20, 30}}, {"scale", {2, 2, 2}}, {"children", {1, 2}}},
      {{"name", "turned"},
       {"rotation", {0, half, 0, half}},
       {"translation", {1, 0, 0}},
       {"scale", {1, 3, 1}},
       {"mesh", 0}},
      {{"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}, {"mesh", 0}}};
  builder.json["meshes"][0]["name"] = "cube";
  const auto scene = builder.read().scene;
  ASSERT_EQ(scene.meshes.size(), 1U) << "a mesh that several nodes use is read once";
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.instances[0].name, "turned");
  EXPECT_EQ(scene.instances[1].name, "cube");
  const Vec3d turned = transform_point(scene.instances[0].to_world, Vec3d(1, 1, 0));
  EXPECT_LT(length(turned - Vec3d(12, 26, 28)), 1e-13);
  EXPECT_TRUE(is_mirroring(scene.instances[1].to_world));
  EXPECT_EQ(transform_point(scene.instances[1].to_world, Vec3d(1, 1, 1)), Vec3d(18, 34, 46));
}

TEST(GltfReader, QuaternionsNeedNotBeUnit) {
  GltfBuilder builder;
  builder.show({{"attributes", {{"POSITION", builder.add_accessor(cube_positions, "VEC3", gltf_float)}}}});
  builder.json["nodes"][0]["rotation"] = {0.3, -0.5, 1.1, 0.7};
  const Mat4d m = builder.read().scene.instances[0].to_world;
  EXPECT_NEAR(length(transform_vector(m, Vec3d(1, 2, 3))), std::sqrt(14.0), 1e-14);
  EXPECT_NEAR(dot(Vec3d(m[0]), cross(Vec3d(m[1]), Vec3d(m[2]))), 1, 1e-14);
}

TEST(GltfReader, ReadsTheDefaultSceneOnly) {
  GltfBuilder builder;
  builder.show({{"attributes", {{"POSITION", builder.add_accessor(cube_positions, "VEC3", gltf_float)}}}});
  builder.json["nodes"].push_back({{"name", "second"}, {"mesh", 0}});
  builder.json["scenes"].push_back({{"nodes", {1}}});
  EXPECT_EQ(builder.read().scene.instances.size(), 1U);
  builder.json["scene"] = 1;
  EXPECT_EQ(builder.read().scene.instances[0].name, "second");
  builder.json.erase("scene");
  EXPECT_EQ(builder.read().scene.instances[0].name, "mesh 0");
  builder.json.erase("scenes");
  EXPECT_EQ(builder.read().scene.instances.size(), 2U);
}

TEST(GltfReader, PrimitivesOfOneLayoutBecomeOneMesh) {
  GltfBuilder builder;
  builder.add("materials", {{"name", "red"}});
  builder.add("materials", {{"name", "blue"}});
  const auto positions = builder.add_accessor(cube_positions, "VEC3", gltf_float);
  const auto half = [&](std::size_t from) {
    return builder.add_accessor(
        std::vector<std::uint32_t>(cube_indices.begin() + static_cast<std::ptrdiff_t>(from),
                                   cube_indices.begin() + static_cast<std::ptrdiff_t>(from) + 18),
        "SCALAR", gltf_uint32);
  };
  const auto mesh = builder.show({{"attributes", {{"POSITION", positions}}}, {"indices", half(0)}, {"material", 1}});
  auto& primitives = builder.json["meshes"][mesh]["primitives"];
  primitives.push_back({{"attributes", {{"POSITION", positions}}}, {"indices", half(18)}, {"material", 0}});
  auto scene = builder.read().scene;
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].positions.size(), 8U) << "vertices that primitives share are kept once";
  EXPECT_DOUBLE_EQ(extent_of(scene).volume, 1);
  ASSERT_EQ(scene.meshes[0].materials.size(), 12U);
  EXPECT_EQ(scene.meshes[0].material_of(0), 1U);
  EXPECT_EQ(scene.meshes[0].material_of(11), 0U);

  primitives[1]["attributes"]["NORMAL"] = builder.add_accessor(std::vector<float>(24, 1.0F), "VEC3", gltf_float);
  scene = builder.read().scene;
  ASSERT_EQ(scene.meshes.size(), 2U) << "other attributes make a mesh of their own";
  EXPECT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.instances[0].name, "mesh 0 (part 1)");
  EXPECT_DOUBLE_EQ(extent_of(scene).volume, 1);
  EXPECT_TRUE(scene.meshes[0].normals.empty());
  EXPECT_FALSE(scene.meshes[1].normals.empty());
}

TEST(GltfReader, UnusedVerticesAreLeftOut) {
  GltfBuilder builder;
  std::vector<float> positions(30, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < 9; ++i) positions[12 + i] = i % 4 == 0 ? 1.0F : 0.0F;
  builder.show({{"attributes", {{"POSITION", builder.add_accessor(positions, "VEC3", gltf_float)}}},
                {"indices", builder.add_accessor<std::uint8_t>({4, 5, 6}, "SCALAR", gltf_uint8)}});
  const auto mesh = builder.read().scene.meshes[0];
  EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
}

TEST(GltfReader, ReadsUvSetsAndColours) {
  GltfBuilder builder;
  builder.show(
      {{"attributes",
        {{"POSITION", builder.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", gltf_float)},
         {"TEXCOORD_0", builder.add_accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", gltf_float)},
         {"TEXCOORD_1", builder.add_accessor<std::uint16_t>({0, 0, 65535, 0, 0, 13107}, "VEC2", gltf_uint16, true)},
         {"TANGENT", builder.add_accessor<float>({2, 0, 0, 1, 1, 0, 0, -1, 0, 0, 1, 1}, "VEC4", gltf_float)},
         {"COLOR_0", builder.add_accessor<std::uint8_t>({255, 51, 0, 1, 2, 3, 4, 5, 6}, "VEC3", gltf_uint8, true)}}}});
  const auto mesh = builder.read().scene.meshes[0];
  EXPECT_EQ(mesh.uv[0][1], Vec2f(1, 0));
  EXPECT_EQ(mesh.uv[1][2], Vec2f(0, 0.2F));
  EXPECT_EQ(mesh.colours[0], Vec4f(1, 0.2F, 0, 1));
  EXPECT_EQ(mesh.tangents[0], Vec4f(1, 0, 0, 1));
  EXPECT_EQ(mesh.tangents[1].w, -1);
}

TEST(GltfReader, FilesOfAllKindsHoldTheSameScene) {
  GltfBuilder builder;
  builder.show({{"attributes", {{"POSITION", builder.add_accessor(cube_positions, "VEC3", gltf_float)}}},
                {"indices", builder.add_accessor(cube_indices, "SCALAR", gltf_uint32)}});
  const TemporaryFolder folder;
  folder.write("sub dir/cube é%.bin", builder.bytes);
  const nlohmann::json buffer = {{"byteLength", builder.bytes.size()}};
  auto external = builder.json;
  external["buffers"] = {buffer};
  for (const char* uri : {"sub%20dir/cube%20%C3%A9%25.bin", "sub dir/cube é%.bin", "other/..\\sub dir/cube%20é%.bin"}) {
    external["buffers"][0]["uri"] = uri;
    const auto loaded = read_gltf(folder.write("scene.gltf", external.dump()));
    EXPECT_DOUBLE_EQ(extent_of(loaded.scene).volume, 1) << uri;
  }
  std::string encoded;
  for (const unsigned char c : builder.bytes) {
    constexpr char digits[] = "0123456789ABCDEF";
    encoded += {'%', digits[c >> 4], digits[c & 15]};
  }
  external["buffers"][0]["uri"] = "data:application/octet-stream," + encoded;
  EXPECT_DOUBLE_EQ(extent_of(read_text(external).scene).volume, 1);
  EXPECT_DOUBLE_EQ(extent_of(builder.read().scene).volume, 1);
}

TEST(GltfReader, Base64OfEveryLengthDecodes) {
  // Buffer views of 1 and 2 bytes after the triangle make the three paddings.
  const std::string triangle = GltfBuilder::packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
  for (std::size_t extra = 0; extra < 3; ++extra) {
    const std::string bytes = triangle + std::string(extra, '\xFE');
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string encoded;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
      std::uint32_t group = 0;
      for (std::size_t k = 0; k < 3; ++k)
        group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
      for (std::size_t k = 0; k < 4; ++k) encoded += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
    }
    GltfBuilder builder;
    builder.show(
        {{"attributes",
          {{"POSITION",
            builder.add("accessors",
                        {{"bufferView", 0}, {"componentType", gltf_float}, {"count", 3}, {"type", "VEC3"}})}}}});
    builder.json["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}}};
    builder.json["buffers"] = {
        {{"byteLength", bytes.size()}, {"uri", "data:application/gltf-buffer;base64," + encoded}}};
    EXPECT_DOUBLE_EQ(extent_of(read_text(builder.json).scene).area, 0.5) << extra;
  }
}

TEST(GltfReader, WhatIsNotDrawnIsOneWarningEach) {
  GltfBuilder builder;
  const auto positions = builder.add_accessor(cube_positions, "VEC3", gltf_float);
  for (int i = 0; i < 2; ++i) {
    builder.show({{"attributes", {{"POSITION", positions}}}});
    builder.show({{"attributes", {{"POSITION", positions}}}, {"mode", i}});  // points, lines
  }
  builder.json["animations"] = {nlohmann::json::object(), nlohmann::json::object()};
  builder.json["extensionsUsed"] = {"ACME_teapots", "ACME_teapots", "KHR_texture_transform", "ACME_spoons"};
  const auto loaded = builder.read();
  EXPECT_EQ(loaded.scene.triangle_count(), 4U);
  EXPECT_EQ(warnings_with(loaded, "points and lines"), 1);
  EXPECT_EQ(warnings_with(loaded, "2 cases, the first in mesh 1, primitive 0"), 1);
  EXPECT_EQ(warnings_with(loaded, "animations"), 1);
  EXPECT_EQ(warnings_with(loaded, "ACME_teapots"), 1);
  EXPECT_EQ(warnings_with(loaded, "ACME_spoons"), 1);
  EXPECT_EQ(warnings_with(loaded, "corners that make no whole triangle"),
            1);  // 8 vertices make 2 triangles and 2 corners
  EXPECT_EQ(loaded.warnings.size(), 5U);
}

TEST(GltfReader, ZeroAreaTrianglesAreKeptAndCounted) {
  GltfBuilder builder;
  builder.show({{"attributes",
                 {{"POSITION", builder.add_accessor<float>({0, 0, 0, 1, 1, 1, 2, 2, 2, 0, 5, 0}, "VEC3", gltf_float)}}},
                {"indices", builder.add_accessor<std::uint8_t>({0, 1, 2, 0, 1, 3, 1, 1, 3}, "SCALAR", gltf_uint8)}});
  const auto loaded = builder.read();
  EXPECT_EQ(loaded.scene.triangle_count(), 3U);
  EXPECT_EQ(warnings_with(loaded, "zero-area triangles were kept but receive no light (2 cases"), 1);
}

TEST(GltfReader, BrokenNormalsAreMended) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  GltfBuilder builder;
  builder.show({{"attributes",
                 {{"POSITION", builder.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", gltf_float)},
                  {"NORMAL", builder.add_accessor<float>({0, 0, 0, nan, 0, 1, 0, 2, 0}, "VEC3", gltf_float)},
                  {"TEXCOORD_0", builder.add_accessor<float>({nan, 0, 1, 0, 0, 1}, "VEC2", gltf_float)}}}});
  const auto loaded = builder.read();
  EXPECT_EQ(loaded.scene.meshes[0].normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(loaded.scene.meshes[0].uv[0][0], Vec2f(0));
  EXPECT_EQ(loaded.warnings.size(), 2U);
}

TEST(GltfReader, AChainOfNodesAsLongAsTheFileIsFollowed) {
  GltfBuilder builder;
  builder.show({{"attributes", {{"POSITION", builder.add_accessor(cube_positions, "VEC3", gltf_float)}}}});
  constexpr int length = 20000;
  auto& nodes = builder.json["nodes"];
  nodes = nlohmann::json::array();
  for (int i = 0; i < length; ++i) nodes.push_back({{"translation", {1, 0, 0}}, {"children", {i + 1}}});
  nodes.push_back({{"mesh", 0}});
  EXPECT_DOUBLE_EQ(builder.read().scene.instances[0].to_world[3].x, length);
}

TEST(GltfReader, AnEmptySceneIsAWarning) {
  const auto loaded = GltfBuilder{}.read();
  EXPECT_EQ(loaded.scene.object_count(), 0U);
  EXPECT_EQ(warnings_with(loaded, "no mesh"), 1);
}

}  // namespace
}  // namespace penumbra::test
