#include "penumbra/io/stl_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "io/temporary_file.h"
#include "penumbra/file/file_error.h"
#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

using test::TemporaryFile;

// A tetrahedron's twelve corners; 4 different ones, one of them with a negative zero.
const std::vector<std::array<float, 3>> tetrahedron{{0, 0, 0},    {0, 1, 0}, {1, 0, 0}, {0, 0, 0},
                                                    {1, 0, 0},    {0, 0, 1}, {0, 0, 0}, {0, 0, 1},
                                                    {-0.F, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

std::string binary(const std::vector<std::array<float, 3>>& corners, std::string header = "binary") {
  header.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(corners.size() / 3);
  header.append(reinterpret_cast<const char*>(&count), 4);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (c % 3 == 0) header.append(12, '\0');
    header.append(reinterpret_cast<const char*>(corners[c].data()), 12);
    if (c % 3 == 2) header.append(2, '\0');
  }
  return header;
}

std::string ascii(const std::vector<std::array<float, 3>>& corners, const std::string& name = "thing") {
  std::string text = "solid " + name + "\n";
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (c % 3 == 0) text += "  facet normal nan 0 0\n    outer loop\n";
    text += "      vertex " + std::to_string(corners[c][0]) + " " + std::to_string(corners[c][1]) + " " +
            std::to_string(corners[c][2]) + "\n";
    if (c % 3 == 2) text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

LoadedScene read_bytes(const std::string& bytes, double unit = 1) {
  const TemporaryFile file(bytes, ".stl");
  return read_stl(file.path(), unit);
}

std::string complaint(const std::string& bytes) {
  try {
    (void)read_bytes(bytes);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

double signed_volume(const Mesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    volume += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6;
  }
  return volume;
}

TEST(StlReader, BinaryAndAsciiGiveTheSameWeldedSolid) {
  for (const std::string& bytes :
       {binary(tetrahedron), binary(tetrahedron, "solid that is binary"), ascii(tetrahedron)}) {
    const Scene scene = read_bytes(bytes).scene;
    ASSERT_EQ(scene.meshes.size(), 1U);
    EXPECT_EQ(scene.meshes[0].positions.size(), 4U);  // -0 and 0 are one
    EXPECT_EQ(scene.meshes[0].triangles.size(), 4U);
    EXPECT_NEAR(signed_volume(scene.meshes[0]), 1.0 / 6, 1e-15);
  }
}

TEST(StlReader, EachAsciiSolidIsAnObject) {
  const Scene scene = read_bytes(ascii(tetrahedron, "first thing") + ascii(tetrahedron, "second")).scene;
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.object_name(0), "first thing");
  EXPECT_EQ(scene.object_name(1), "second");
  EXPECT_EQ(scene.meshes[0].face_lines.at(1), 9U);
}

TEST(StlReader, ScalesByTheUnit) {
  EXPECT_NEAR(signed_volume(read_bytes(binary(tetrahedron), 1e-3).scene.meshes[0]), 1e-9 / 6, 1e-24);
}

TEST(StlReader, RefusesWhatIsNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    auto corners = tetrahedron;
    corners[7][1] = bad;
    EXPECT_NE(complaint(binary(corners)).find("facet 3"), std::string::npos);
    EXPECT_NE(complaint(ascii(corners)).find("line "), std::string::npos);
  }
}

TEST(StlReader, ChecksTheCountBeforeItAllocates) {
  std::string bytes = binary(tetrahedron);
  const std::uint32_t most = 0xFFFFFFFFU;  // 214 GB of facets
  std::memcpy(&bytes[80], &most, 4);
  EXPECT_NE(complaint(bytes).find("4294967295 facets"), std::string::npos);
  const std::uint32_t none = 0;
  std::memcpy(&bytes[80], &none, 4);
  EXPECT_NE(complaint(bytes), "");
}

TEST(StlReader, ToleratesTrailingBytesWithAWarning) {
  const auto loaded = read_bytes(binary(tetrahedron) + "extra");
  EXPECT_EQ(loaded.scene.meshes[0].triangles.size(), 4U);
  EXPECT_EQ(loaded.warnings.size(), 1U);
}

TEST(StlReader, RefusesEveryTruncation) {
  const std::string bytes = binary(tetrahedron);
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_NE(complaint(bytes.substr(0, size)), "") << size;
  const std::string text = ascii(tetrahedron);
  const std::size_t end = text.find("endsolid");
  for (std::size_t size = 0; size < end; ++size) EXPECT_NE(complaint(text.substr(0, size)), "") << size;
}

TEST(StlReader, SaysWhatItExpected) {
  const std::string said = complaint("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvortex 1 0 0\n");
  EXPECT_NE(said.find("line 5: expected 'vertex' but found 'vortex'"), std::string::npos) << said;
  EXPECT_NE(complaint("not a mesh at all"), "");
  EXPECT_NE(complaint("solid a\nendsolid a\n"), "");
  EXPECT_NE(complaint(""), "");
}

TEST(StlReader, SurvivesCorruption) {
  for (const std::string& whole : {binary(tetrahedron), ascii(tetrahedron)}) {
    for (std::uint64_t round = 0; round < 1000; ++round) {
      CounterRng rng(round);
      std::string bytes = whole;
      for (std::uint64_t hits = 1 + rng.next_bits() % 6; hits > 0; --hits) {
        bytes[rng.next_bits() % bytes.size()] = static_cast<char>(rng.next_bits());
      }
      try {
        const Scene scene = read_bytes(bytes).scene;
        for (const Mesh& mesh : scene.meshes) {
          for (const auto& t : mesh.triangles) {
            for (const auto v : t) ASSERT_LT(v, mesh.positions.size());
          }
        }
      } catch (const FileError&) {
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
