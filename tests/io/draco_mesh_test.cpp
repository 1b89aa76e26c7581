#include "penumbra/io/draco_mesh.h"

#include <draco/compression/encode.h>
#include <draco/core/encoder_buffer.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <stdexcept>

#include "io/gltf_builder.h"
#include "penumbra/file/file_error.h"
#include "penumbra/math/rng.h"

namespace penumbra::test {
namespace {

constexpr int sides = 12;  // of the sheet
constexpr int triangle_total = sides * sides * 2;

/// Corner positions, normals and uvs of a wavy sheet: exactly what floats hold.
struct Sheet {
  std::vector<float> positions;
  std::vector<float> normals;
  std::vector<float> uvs;

  Sheet() {
    for (int y = 0; y < sides; ++y) {
      for (int x = 0; x < sides; ++x) {
        for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) add(x + dx, y + dy);
      }
    }
  }
  void add(int x, int y) {
    const auto u = static_cast<float>(x) / sides;
    const auto v = static_cast<float>(y) / sides;
    positions.insert(positions.end(), {u, v, 0.25F * std::sin(5 * u) * v});
    normals.insert(normals.end(), {0, 0.6F, 0.8F});
    uvs.insert(uvs.end(), {u, v});
  }
};

enum class Method { edgebreaker, sequential };

/// The sheet compressed by Draco without quantisation, so that values stay exact. Attribute ids: 0, 1, 2.
std::string compressed(const Sheet& sheet, Method method, int speed = 5) {
  draco::TriangleSoupMeshBuilder soup;
  soup.Start(triangle_total);
  const int ids[] = {soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
                     soup.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32),
                     soup.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32)};
  const std::vector<float>* values[] = {&sheet.positions, &sheet.normals, &sheet.uvs};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t width = a == 2 ? 2 : 3;
    for (int f = 0; f < triangle_total; ++f) {
      const float* corner = values[a]->data() + static_cast<std::size_t>(f) * 3 * width;
      soup.SetAttributeValuesForFace(ids[a], draco::FaceIndex(static_cast<std::uint32_t>(f)), corner, corner + width,
                                     corner + 2 * width);
    }
  }
  const std::unique_ptr<draco::Mesh> mesh = soup.Finalize();
  draco::Encoder encoder;
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetEncodingMethod(method == Method::edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                                          : draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw std::runtime_error("Draco did not encode");
  return {buffer.data(), buffer.size()};
}

GltfBuilder gltf_of(const std::string& draco_bytes) {
  GltfBuilder builder;
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const auto accessor = [&](const char* type) {
    return builder.add("accessors",
                       {{"componentType", gltf_float}, {"count", (sides + 1) * (sides + 1)}, {"type", type}});
  };
  nlohmann::json primitive;
  primitive["attributes"] = {
      {"POSITION", accessor("VEC3")}, {"NORMAL", accessor("VEC3")}, {"TEXCOORD_0", accessor("VEC2")}};
  primitive["indices"] =
      builder.add("accessors", {{"componentType", gltf_uint16}, {"count", triangle_total * 3}, {"type", "SCALAR"}});
  primitive["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", builder.add_view(draco_bytes)},
      {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  builder.show(primitive);
  return builder;
}

GltfBuilder plain_gltf_of(const Sheet& sheet) {
  GltfBuilder builder;
  builder.show({{"attributes",
                 {{"POSITION", builder.add_accessor(sheet.positions, "VEC3", gltf_float)},
                  {"NORMAL", builder.add_accessor(sheet.normals, "VEC3", gltf_float)},
                  {"TEXCOORD_0", builder.add_accessor(sheet.uvs, "VEC2", gltf_float)}}}});
  return builder;
}

/// Every triangle with all that its corners hold, whatever the order of triangles and vertices.
std::multiset<std::vector<double>> content_of(const Mesh& mesh) {
  std::multiset<std::vector<double>> content;
  for (const auto& t : mesh.triangles) {
    std::vector<std::vector<double>> corners;
    for (const auto v : t) {
      const Vec3d& p = mesh.positions[v];
      const Vec3f& n = mesh.normals[v];
      const Vec2f& uv = mesh.uv[0][v];
      corners.push_back({p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y});
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::vector<double> flat;
    for (const auto& corner : corners) flat.insert(flat.end(), corner.begin(), corner.end());
    content.insert(flat);
  }
  return content;
}

TEST(DracoMesh, HoldsWhatThePlainMeshHolds) {
  const Sheet sheet;
  const auto plain = plain_gltf_of(sheet).read().scene;
  for (const Method method : {Method::edgebreaker, Method::sequential}) {
    for (const int speed : {0, 5, 10}) {
      const auto loaded = gltf_of(compressed(sheet, method, speed)).read();
      ASSERT_EQ(loaded.scene.triangle_count(), static_cast<std::size_t>(triangle_total));
      EXPECT_EQ(content_of(loaded.scene.meshes[0]), content_of(plain.meshes[0])) << speed;
      EXPECT_LT(loaded.scene.meshes[0].positions.size(), 3U * triangle_total) << "vertices are shared";
      EXPECT_TRUE(loaded.warnings.empty());
    }
  }
}

TEST(DracoMesh, AnAttributeThatIsNotThereIsAnError) {
  auto builder = gltf_of(compressed(Sheet(), Method::edgebreaker));
  auto& attributes =
      builder.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"];
  attributes["POSITION"] = 17;
  EXPECT_THROW((void)builder.read(), FileError);
}

TEST(DracoMesh, DamagedBytesGiveAMeshOrAnError) {
  const std::string good[] = {compressed(Sheet(), Method::edgebreaker), compressed(Sheet(), Method::sequential)};
  const std::uint32_t wanted[] = {0, 1, 2};
  CounterRng random(2024);
  int refused = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    std::string bytes = good[trial % 2];
    const auto flips = 1 + random.next_bits() % 4;
    for (std::uint64_t i = 0; i < flips; ++i)
      bytes[random.next_bits() % bytes.size()] = static_cast<char>(random.next_bits());
    if (trial % 5 == 0) bytes.resize(random.next_bits() % bytes.size());
    try {
      const auto mesh = decode_draco(std::as_bytes(std::span(bytes)), wanted);
      for (const auto& t : mesh.triangles) {
        for (const auto corner : t) ASSERT_LT(corner, mesh.vertex_count);
      }
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace penumbra::test
