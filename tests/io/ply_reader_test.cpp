#include "penumbra/io/ply_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "io/temporary_file.h"
#include "penumbra/file/file_error.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

using test::TemporaryFile;

// An L of six corners and a triangle on it, with colours, an element to be passed over, and a second list.
const std::vector<std::array<float, 3>> places{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
const std::vector<std::vector<int>> faces{{0, 1, 2, 3, 4, 5}, {0, 1, 2}};

std::string header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nelement odd 1\nproperty list uchar short "
         "data\n"
         "property double weight\nelement face 2\nproperty uchar flags\nproperty list uchar int "
         "vertex_indices\nend_header\n";
}

std::string ascii() {
  std::string text = header("ascii");
  for (const auto& p : places) {
    text += std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + " 255 0 128\n";
  }
  text += "3 1 2 3 0.5\n";
  for (const auto& f : faces) {
    text += "7 " + std::to_string(f.size());
    for (const int v : f) text += " " + std::to_string(v);
    text += "\n";
  }
  return text;
}

template <class T>
void append(std::string& bytes, T value, bool big) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  if (big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

std::string binary(bool big) {
  std::string bytes = header(big ? "binary_big_endian" : "binary_little_endian");
  for (const auto& p : places) {
    for (const float x : p) append(bytes, x, big);
    bytes += "\xff";
    bytes += '\0';
    bytes += "\x80";
  }
  bytes += '\3';
  for (const std::int16_t v : {1, 2, 3}) append(bytes, v, big);
  append(bytes, 0.5, big);
  for (const auto& f : faces) {
    bytes += '\7';
    bytes += static_cast<char>(f.size());
    for (const int v : f) append(bytes, v, big);
  }
  return bytes;
}

LoadedScene read_bytes(const std::string& bytes, double unit = 1) {
  const TemporaryFile file(bytes, ".ply");
  return read_ply(file.path(), unit);
}

std::string complaint(const std::string& bytes) {
  try {
    (void)read_bytes(bytes);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

TEST(PlyReader, ThreeEncodingsGiveTheSamePolygons) {
  for (const std::string& bytes : {ascii(), binary(false), binary(true)}) {
    const Scene scene = read_bytes(bytes).scene;
    ASSERT_EQ(scene.meshes.size(), 1U);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.face_count(), 2U);
    EXPECT_EQ(mesh.face(0).size(), 6U);
    EXPECT_EQ(mesh.triangles.size(), 5U);
    double of_first = 0;  // the concave face is covered once by its triangles
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      std::vector<Vec3d> corners;
      for (const auto v : mesh.triangles[t]) corners.push_back(mesh.positions[v]);
      EXPECT_GT(newell_vector(corners).z, 0);
      if (mesh.face_of_triangle[t] == 0) of_first += polygon_area(corners);
    }
    EXPECT_DOUBLE_EQ(of_first, 3);
    ASSERT_EQ(mesh.colours.size(), 6U);
    EXPECT_FLOAT_EQ(mesh.colours[0].x, 1);
    EXPECT_NEAR(mesh.colours[0].z, 0.21586, 1e-4);  // sRGB 128
  }
}

TEST(PlyReader, AcceptsWindowsLineEnds) {
  std::string text;
  for (const char c : ascii()) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(read_bytes(text).scene.meshes[0].face_count(), 2U);
}

TEST(PlyReader, ScalesByTheUnit) {
  EXPECT_NEAR(read_bytes(ascii(), 0.0254).scene.meshes[0].bounds().upper.x, 2 * 0.0254, 1e-15);
}

TEST(PlyReader, NamesTheMistake) {
  const std::string good = ascii();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bad = good;
    bad.replace(bad.find(from), from.size(), to);
    return complaint(bad);
  };
  EXPECT_NE(with("7 3 0 1 2", "7 3 0 1 9").find("vertex 9"), std::string::npos);
  EXPECT_NE(with("7 3 0 1 2", "7 2 0 1").find("2 corners"), std::string::npos);
  EXPECT_NE(with("7 3 0 1 2", "7 3 0 1").find("missing"), std::string::npos);
  EXPECT_NE(with("7 3 0 1 2", "7 -3 0 1 2").find("-3"), std::string::npos);
  EXPECT_NE(with("element vertex 6", "element vertex 6000000000").find("line 4"), std::string::npos);
  EXPECT_NE(with("element vertex 6", "element vertex 4000000000").find("4000000000"), std::string::npos);
  EXPECT_NE(with("property float x", "property float q").find("lacks x"), std::string::npos);
  EXPECT_NE(with("property float x", "property half x").find("'half'"), std::string::npos);
  EXPECT_NE(with("format ascii", "format roman").find("'roman'"), std::string::npos);
  EXPECT_NE(with("ply", "plow").find("first line"), std::string::npos);
  EXPECT_NE(with("2.000000", "nan").find("line "), std::string::npos);
  EXPECT_NE(complaint("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
                      "z\nend_header\n0 0 0\n")
                .find("no faces"),
            std::string::npos);
  EXPECT_NE(complaint(""), "");
}

TEST(PlyReader, RefusesEveryTruncation) {
  for (const std::string& whole : {binary(false), binary(true)}) {
    for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_NE(complaint(whole.substr(0, size)), "") << size;
  }
}

TEST(PlyReader, SurvivesCorruption) {
  for (const std::string& whole : {ascii(), binary(false), binary(true)}) {
    for (std::uint64_t round = 0; round < 1000; ++round) {
      CounterRng rng(round);
      std::string bytes = whole;
      for (std::uint64_t hits = 1 + rng.next_bits() % 6; hits > 0; --hits) {
        bytes[rng.next_bits() % bytes.size()] = static_cast<char>(rng.next_bits());
      }
      try {
        const Scene scene = read_bytes(bytes).scene;
        for (const auto& t : scene.meshes[0].triangles) {
          for (const auto v : t) ASSERT_LT(v, scene.meshes[0].positions.size());
        }
      } catch (const FileError&) {
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
