#include "penumbra/io/obj_reader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/image/image_io.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

/// A folder of this test alone, with the OBJ, MTL and pictures that it writes.
class ObjReader : public testing::Test {
 protected:
  ObjReader()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("penumbra-obj-" + std::to_string(::getpid()) + "-" +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~ObjReader() override { std::filesystem::remove_all(folder_); }

  void write(const char* name, std::string_view text) const { std::ofstream(folder_ / name, std::ios::binary) << text; }

  [[nodiscard]] LoadedScene read(std::string_view obj, double unit = 1) const {
    write("model.obj", obj);
    return read_obj(folder_ / "model.obj", {.unit = unit});
  }

  /// The scene of an OBJ that is in order: no warnings.
  [[nodiscard]] Scene read_quietly(std::string_view obj, double unit = 1) const {
    auto loaded = read(obj, unit);
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    return std::move(loaded.scene);
  }

  /// The material of a triangle for which the MTL file is `mtl` and its only material is called m.
  [[nodiscard]] Material material(std::string_view mtl) const {
    write("model.mtl", "newmtl m\n" + std::string(mtl));
    const auto loaded = read("mtllib model.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    return loaded.scene.materials.at(0);
  }

  void expect_refused(std::string_view obj, std::string_view place, std::string_view part) const {
    try {
      static_cast<void>(read(obj));
      ADD_FAILURE() << "was read: " << obj;
    } catch (const FileError& error) {
      EXPECT_EQ(error.path(), (folder_ / "model.obj").string());
      EXPECT_EQ(error.place(), place) << error.what();
      EXPECT_NE(std::string_view(error.what()).find(part), std::string_view::npos) << error.what();
    }
  }

  static void expect_one_warning(const LoadedScene& loaded, std::string_view part) {
    ASSERT_EQ(loaded.warnings.size(), 1U);
    EXPECT_NE(loaded.warnings[0].find(part), std::string::npos) << loaded.warnings[0];
  }

  std::filesystem::path folder_;
};

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    area += polygon_area(std::vector{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  }
  return area;
}

constexpr const char* square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(ObjReader, ASquareIsOneFaceOfTwoTriangles) {
  const Scene scene = read_quietly(std::string(square) + "f 1 2 3 4\n");
  ASSERT_EQ(scene.meshes.size(), 1U);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.name, "model");
  EXPECT_EQ(mesh.positions.size(), 4U);
  ASSERT_EQ(mesh.face_count(), 1U);
  EXPECT_TRUE(std::ranges::equal(mesh.face(0), std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.face_of_triangle, (std::vector<std::uint32_t>{0, 0}));
  EXPECT_DOUBLE_EQ(area_of(mesh), 1);
  EXPECT_EQ(mesh.materials, std::vector<std::uint32_t>{0});
  EXPECT_EQ(scene.materials.at(0).base_colour, Rgb(0.8F));
  EXPECT_EQ(scene.materials[0].specular, 0.0F);
  EXPECT_TRUE(mesh.normals.empty() && mesh.uv[0].empty() && mesh.colours.empty());
}

TEST_F(ObjReader, TheUnitScalesPositionsInDoublePrecision) {
  const Scene scene = read_quietly("v 0.1 0 0\nv 1000000.0000001 0 0\nv 0 3 0\nf 1 2 3\n", 0.001);
  EXPECT_DOUBLE_EQ(scene.meshes[0].positions[0].x, 0.0001);
  EXPECT_DOUBLE_EQ(scene.meshes[0].positions[1].x, 1000.0000000001);
}

TEST_F(ObjReader, CornersShareAVertexOnlyWhereAllThreeIndicesAgree) {
  const Scene scene = read_quietly(std::string(square) +
                                   "vt 0 0\nvt 1 0.25\nvn 0 0 2\nvn 0 1 0\n"
                                   "f 1/1/1 2/2/1 3/1/1\nf 1/1/1 3/1/1 4/2/1\nf 1/2/1 2/2/2 3/1/1\n");
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.positions.size(), 6U);  // 4, and two that differ in vt or vn
  EXPECT_EQ(mesh.triangles[1][0], mesh.triangles[0][0]);
  EXPECT_NE(mesh.triangles[2][0], mesh.triangles[0][0]);
  EXPECT_EQ(mesh.normals[0], Vec3f(0, 0, 1));
  EXPECT_EQ(mesh.uv[0][0], Vec2f(0, 1));  // v downwards
  EXPECT_EQ(mesh.uv[0][1], Vec2f(1, 0.75F));
  EXPECT_TRUE(mesh.face_offsets.empty());  // triangles are their own faces
}

TEST_F(ObjReader, NegativeIndicesCountBackFromTheFace) {
  const Scene scene = read_quietly("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -3 -1\n");
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.positions[mesh.triangles[0][0]], Vec3d(0, 0, 0));
  EXPECT_EQ(mesh.positions[mesh.triangles[1][2]], Vec3d(0, 0, 1));
  EXPECT_EQ(scene.bounds().upper, Vec3d(1, 1, 1));  // the first position belongs to no face
}

TEST_F(ObjReader, LineEndsContinuationsCommentsAndByteOrderMark) {
  const std::string plain = std::string(square) + "f 1 2 3 4\n";
  std::string dos, mac;
  for (const char c : plain) {
    if (c == '\n') dos += '\r';
    dos += c;
    mac += c == '\n' ? '\r' : c;
  }
  const std::string fancy =
      "\xef\xbb\xbf# made by hand\n\n   \n" + std::string(square) + "f 1 2 \\\n 3 \\\r\n4 # a square\n#end";
  const std::string unended = plain.substr(0, plain.size() - 1);
  for (const std::string& text : {plain, dos, mac, fancy, unended}) {
    const Scene scene = read_quietly(text);
    ASSERT_EQ(scene.meshes.size(), 1U);
    EXPECT_EQ(scene.meshes[0].face_count(), 1U);
    EXPECT_DOUBLE_EQ(area_of(scene.meshes[0]), 1);
  }
}

TEST_F(ObjReader, ObjectsBecomeMeshesElseGroupsDo) {
  const std::string faces = std::string(square) + "o left\ng a\nf 1 2 3\no right\ng a\nf 1 3 4\nf 2 3 4\no empty\n";
  const Scene objects = read_quietly(faces);
  ASSERT_EQ(objects.instances.size(), 2U);
  EXPECT_EQ(objects.object_name(0), "left");
  EXPECT_EQ(objects.object_name(1), "right");
  EXPECT_EQ(objects.triangle_count(), 3U);
  const Scene groups =
      read_quietly(std::string(square) + "f 1 2 4\ng top side\nf 1 2 3\ng b\nf 1 3 4\ng top side\nf 2 3 4\n");
  ASSERT_EQ(groups.instances.size(), 3U);
  EXPECT_EQ(groups.object_name(0), "model");
  EXPECT_EQ(groups.object_name(1), "top side");
  EXPECT_EQ(groups.meshes[1].triangles.size(), 2U);
}

TEST_F(ObjReader, MaterialsAreKeptForEachTriangle) {
  write("model.mtl", "newmtl red\nKd 1 0 0\nnewmtl unused\nKd 0 1 0\nnewmtl blue\nKd 0 0 1\n");
  const Scene scene = read_quietly("mtllib model.mtl\n" + std::string(square) +
                                   "usemtl blue\nf 1 2 3 4\nusemtl red # at last\nf 1 2 3\n");
  ASSERT_EQ(scene.materials.size(), 2U);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(scene.materials[mesh.material_of(0)].base_colour, Rgb(0, 0, 1));
  EXPECT_EQ(scene.materials[mesh.material_of(1)].base_colour, Rgb(0, 0, 1));
  EXPECT_EQ(scene.materials[mesh.material_of(2)].base_colour, Rgb(1, 0, 0));
}

TEST_F(ObjReader, ConcavePolygonsKeepTheirArea) {
  // An L of area 3, and a comb whose teeth defeat a fan.
  const Scene scene = read_quietly("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n");
  EXPECT_DOUBLE_EQ(area_of(scene.meshes[0]), 3);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 4U);
  EXPECT_EQ(scene.meshes[0].face_count(), 1U);
  std::string comb, face = "f";
  const int teeth = 50;
  for (int i = 0; i < teeth; ++i) {
    const double x = 2.0 * i;
    for (const auto& [dx, y] : {std::pair{0.0, 5.0}, {0.1, 0.5}, {1.9, 0.5}}) {
      comb += fmt::format("v {} {} 0\n", x + dx, y);
    }
  }
  comb += "v 100 5 0\nv 100 0 0\nv 0 0 0\n";
  for (int i = 3 * teeth + 3; i >= 1; --i) face += fmt::format(" {}", i);
  const Scene combs = read_quietly(comb + face + "\n");
  std::vector<Vec3d> outline;
  for (const std::uint32_t v : combs.meshes[0].face(0)) outline.push_back(combs.meshes[0].positions[v]);
  EXPECT_EQ(outline.size(), static_cast<std::size_t>(3 * teeth + 3));
  EXPECT_NEAR(area_of(combs.meshes[0]), polygon_area(outline), 1e-9);
  for (const auto& t : combs.meshes[0].triangles) {
    const auto& p = combs.meshes[0].positions;
    EXPECT_GE(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z, 0);
  }
}

TEST_F(ObjReader, ManyCorneredDiscsAreCutFast) {
  std::string text, face = "f";
  const int corners = 20000;
  for (int i = 1; i <= corners; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / corners;
    text += fmt::format("v {:.9f} {:.9f} 0\n", 1000 * std::cos(angle), 1000 * std::sin(angle));
    face += fmt::format(" {}", i);
  }
  const Scene scene = read_quietly(text + face + "\n");
  EXPECT_EQ(scene.meshes[0].triangles.size(), static_cast<std::size_t>(corners - 2));
  EXPECT_NEAR(area_of(scene.meshes[0]), 3.14159265358979 * 1e6, 1);
}

TEST_F(ObjReader, BentPolygonsBecomeTrianglesWithOneWarning) {
  const auto loaded = read(
      "v 0 0 0\nv 1 0 0\nv 1 1 0.01\nv 0 1 0\nv 0 0 5\nv 1 0 5\nv 1 1 5.01\nv 0 1 5\n"
      "f 1 2 3 4\nf 5 6 7 8\n");
  expect_one_warning(loaded, "2 cases");
  EXPECT_EQ(loaded.scene.meshes[0].face_count(), 4U);
  EXPECT_EQ(loaded.scene.meshes[0].triangles.size(), 4U);
  // A bend of a millionth of the size is rounding, not shape.
  EXPECT_EQ(read_quietly("v 0 0 0\nv 1 0 0\nv 1 1 0.000001\nv 0 1 0\nf 1 2 3 4\n").meshes[0].face_count(), 1U);
}

TEST_F(ObjReader, OutlinesThatCrossThemselvesAreRefused) {
  expect_refused(std::string(square) + "f 1 2 3 4\n\nf 1 3 2 4\n", "line 7", "crosses itself");  // loops cancel
  expect_refused("v 0 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3 4\n", "line 5", "crosses itself");
  // A five-pointed star by its tips turns round twice without turning back.
  std::string star;
  for (int i = 0; i < 5; ++i) {
    star += fmt::format("v {} {} 0\n", std::cos(i * 2.513274), std::sin(i * 2.513274));
  }
  expect_refused(star + "f 1 2 3 4 5\n", "line 6", "crosses itself");
}

TEST_F(ObjReader, OutlinesThatTouchThemselvesBecomeTriangles) {
  // A square with a square hole, joined by a bridge that is walked twice.
  const auto loaded =
      read("v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\nf 1 2 3 4 1 5 6 7 8 5\n");
  expect_one_warning(loaded, "touches itself");
  EXPECT_DOUBLE_EQ(area_of(loaded.scene.meshes[0]), 8);
  EXPECT_EQ(loaded.scene.meshes[0].face_count(), loaded.scene.meshes[0].triangles.size());
}

TEST_F(ObjReader, FacesWithoutAreaAreKeptAndCounted) {
  const auto loaded = read(std::string(square) + "f 1 2 3\nf 1 2 2\nf 1 1 1 1\n");
  expect_one_warning(loaded, "without area");
  EXPECT_EQ(loaded.scene.triangle_count(), 3U);
  EXPECT_DOUBLE_EQ(area_of(loaded.scene.meshes[0]), 0.5);
}

TEST_F(ObjReader, ARepeatedCornerOfAPolygonIsDropped) {
  const Scene scene = read_quietly(std::string(square) + "f 1 2 2 3\nf 1 1 2 3 4\n");
  EXPECT_EQ(scene.meshes[0].face_count(), 2U);
  EXPECT_EQ(scene.meshes[0].face(0).size(), 3U);
  EXPECT_EQ(scene.meshes[0].face(1).size(), 4U);
}

TEST_F(ObjReader, FacesWithoutNormalsAmongOthersAreFlat) {
  const Scene scene = read_quietly(std::string(square) + "v 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1 3 4\nf 1 5 2\n");
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_EQ(mesh.normals[mesh.triangles[0][0]], Vec3f(1, 0, 0));
  EXPECT_EQ(mesh.normals[mesh.triangles[1][0]], Vec3f(0, 0, 1));
  EXPECT_EQ(mesh.normals[mesh.triangles[2][0]], Vec3f(0, 1, 0));
}

TEST_F(ObjReader, ColoursOfPositions) {
  const Scene scene = read_quietly("v 0 0 0 0.5 0.25 0\nv 1 0 0\nv 0 1 0 1 1 1\nf 1 2 3\n");
  EXPECT_EQ(scene.meshes[0].colours, (std::vector<Vec4f>{{0.5F, 0.25F, 0, 1}, {1, 1, 1, 1}, {1, 1, 1, 1}}));
  expect_one_warning(read("v 0 0 0 255 0 0\nv 1 0 0 0 255 0\nv 0 1 0 1 1 1\nf 1 2 3\n"), "0..255");
}

TEST_F(ObjReader, BadLinesAreRefusedByNumber) {
  const std::string v = square;  // lines 1 to 4
  expect_refused(v + "v 0 nan 0\nf 1 2 3\n", "line 5", "not a finite number");
  expect_refused(v + "v 0 0 -inf\nf 1 2 3\n", "line 5", "not a finite number");
  expect_refused(v + "v 0 0 1e999\nf 1 2 3\n", "line 5", "not a finite number");
  expect_refused(v + "v 0 0\nf 1 2 3\n", "line 5", "z of the position is missing");
  expect_refused(v + "v 0 0 1,5\nf 1 2 3\n", "line 5", "should be a number");
  expect_refused(v + "f 1 2 5\n", "line 5", "position 5, but the file has 4");
  expect_refused(v + "f 1 2 -5\n", "line 5", "only 4 stand before it");
  expect_refused(v + "f 0 1 2\n", "line 5", "counted from 1");
  expect_refused(v + "f 1/1 2/1 3/1\n", "line 5", "texture coordinate 1, but the file has 0");
  expect_refused(v + "f 1//1 2//1 3//1\n", "line 5", "normal 1, but the file has 0");
  expect_refused(v + "f 1 2\n", "line 5", "has 2 corners");
  expect_refused(v + "f 1 2 x\n", "line 5", "no corner of a face");
  expect_refused(v + "f 1 2 99999999999999999999\n", "line 5", "no corner of a face");
  expect_refused(v + "f 1 2 9999999999\n", "line 5", "beyond");
  expect_refused("", "", "holds no faces");
  expect_refused("v 0 0 0\n", "", "holds no faces");
  EXPECT_THROW(static_cast<void>(read_obj(folder_ / "none.obj")), FileError);
  EXPECT_THROW(static_cast<void>(read_quietly(v + "f 1 2 3\n", 0)), std::invalid_argument);
}

TEST_F(ObjReader, UnknownStatementsAreCountedInOneWarning) {
  expect_one_warning(read(std::string(square) + "shadow_obj a.obj\nlod 3\ns off\nf 1 2 3\n"),
                     "2 cases, the first in line 5");
}

TEST_F(ObjReader, FreeFormElementsAreCountedAsWhole) {
  const std::string curve = "curv 0 1 1 2 \\\n 3 4\nparm u 0 0 1 1\nend\n";
  expect_one_warning(
      read(std::string(square) + "cstype bezier\r\ndeg 3\r\n" + curve + "vp 1 2\n" + curve + "f 1 2 3\n"),
      "free-form curves and surfaces are not drawn; convert them to polygons (2 cases, the first in line 7");
}

TEST_F(ObjReader, Utf16IsNamed) {
  for (const std::string_view text : {std::string_view("\xFE\xFF\0v\0 ", 6), std::string_view("v\0 \0"
                                                                                              "1\0",
                                                                                              6)}) {
    try {
      (void)read(std::string(text));
      ADD_FAILURE();
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("UTF-16"), std::string::npos) << error.what();
    }
  }
}

TEST_F(ObjReader, AMissingMtlFileIsOneWarning) {
  const auto loaded = read("mtllib none.mtl\nusemtl wood\n" + std::string(square) + "f 1 2 3\nusemtl steel\nf 1 3 4\n");
  expect_one_warning(loaded, "none.mtl");
  EXPECT_EQ(loaded.scene.materials.at(0).base_colour, Rgb(0.8F));
}

// A corner named over and over is dropped in one go; taking each out by itself took the square of them.
TEST_F(ObjReader, ACornerRepeatedAHundredThousandTimesIsOne) {
  std::string face = "f";
  for (int i = 0; i < 100000; ++i) face += " 1";
  const Scene scene = read_quietly(std::string(square) + face + " 2 3 3 3 4\n");
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2U);
  EXPECT_EQ(scene.meshes[0].positions.size(), 4U);
}

// A pipe would wait for ever, and a library that is named again and again would be read as often.
TEST_F(ObjReader, LibrariesAreFilesAndReadOnce) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe.mtl").c_str(), 0600), 0);
  expect_one_warning(read("mtllib pipe.mtl\n" + std::string(square) + "f 1 2 3\n"), "no ordinary file");
  write("model.mtl", "newmtl m\nKd 0.5 0.5 0.5\nnewmtl m\n");
  const auto loaded =
      read("mtllib model.mtl\nmtllib ./model.mtl model.mtl\nusemtl m\n" + std::string(square) + "f 1 2 3\n");
  expect_one_warning(loaded, "materials of one name");
  EXPECT_EQ(loaded.warnings[0].find("cases"), std::string::npos) << loaded.warnings[0];
}

TEST_F(ObjReader, FilesOutsideTheFolderAreNotRead) {
  for (const char* name : {"../model.mtl", "/etc/passwd", "a/../../b.mtl", "C:\\model.mtl"}) {
    expect_one_warning(read("mtllib " + std::string(name) + "\n" + square + "f 1 2 3\n"), "outside the folder");
  }
  write("model.mtl", "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd ../secret.png\n");
  const auto loaded = read("mtllib model.mtl\nusemtl m\n" + std::string(square) + "f 1 2 3\n");
  expect_one_warning(loaded, "outside the folder");
  EXPECT_EQ(loaded.scene.materials[0].base_colour, Rgb(0.5F));
}

TEST_F(ObjReader, MattMaterialsArePurelyLambertian) {
  for (const char* mtl :
       {"Kd 0.2 0.3 0.4\n", "Kd 0.2 0.3 0.4\nKs 0 0 0\nillum 2\n", "Kd 0.2 0.3 0.4\nKs 0 0 0\nNs 90\nillum 1\n",
        "Kd 0.2 0.3 0.4\nillum 0\nNi 1.45\nd 1\nKa 1 1 1\n"}) {
    const Material m = material(mtl);
    EXPECT_EQ(m.base_colour, Rgb(0.2F, 0.3F, 0.4F));
    EXPECT_EQ(m.specular, 0.0F);
    EXPECT_EQ(m.metallic, 0.0F);
    EXPECT_EQ(m.transmission, 0.0F);
    EXPECT_EQ(m.mirror, Rgb(0.0F));
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_FALSE(m.emits());
  }
}

TEST_F(ObjReader, GlossMirrorGlassAndBlend) {
  const Material gloss = material("Kd 0.2 0.2 0.2\nKs 0.04 0.02 0.01\nNs 30\nillum 2\n");
  EXPECT_EQ(gloss.specular, 1.0F);
  EXPECT_NEAR(gloss.specular_colour.x, 1.0F, 1e-6F);
  EXPECT_NEAR(gloss.specular_colour.y, 0.5F, 1e-6F);
  EXPECT_NEAR(gloss.roughness, 0.5F, 1e-6F);  // alpha = sqrt(2 / 32) = 1/4

  const Material mirror = material("Kd 0.1 0.1 0.1\nKs 0.9 0.8 0.7\nillum 3\n");
  EXPECT_EQ(mirror.mirror, Rgb(0.9F, 0.8F, 0.7F));
  EXPECT_EQ(mirror.specular, 0.0F);

  const Material glass = material("Kd 0 0 0\nKs 1 1 1\nNi 1.33\nTf 0.5 1 1\nillum 7\n");
  EXPECT_EQ(glass.transmission, 1.0F);
  EXPECT_EQ(glass.ior, 1.33F);
  EXPECT_EQ(glass.roughness, 0.0F);
  EXPECT_EQ(glass.base_colour, Rgb(0.5F, 1, 1));
  EXPECT_FALSE(glass.thin_walled);

  EXPECT_EQ(material("Kd 0 0 0\nNi 1.5\nd 0\n").transmission, 1.0F);
  EXPECT_EQ(material("Kd 0 0 0\nNi 1.5\nd 0.25\n").transmission, 0.75F);
  EXPECT_EQ(material("Kd 0 0 0\nNi 1.5\nd 0.25\n").base_colour, Rgb(1.0F));

  const Material veil = material("Kd 1 0 0\nTr 0.75\n");
  EXPECT_EQ(veil.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(veil.alpha, 0.25F);
  EXPECT_EQ(veil.transmission, 0.0F);
  EXPECT_EQ(material("Kd 1 0 0\nd 1\nTr 1\n").alpha_mode, AlphaMode::opaque);  // d rules over Tr
}

TEST_F(ObjReader, EmissionIsRadiance) {
  EXPECT_EQ(material("Kd 0 0 0\nKe 17 12 4\n").emission, Rgb(17, 12, 4));
  EXPECT_EQ(material("Kd 0 0 0\nKe 5\n").emission, Rgb(5));
}

TEST_F(ObjReader, AmbientAboveOneIsALampOnlyWhereNoKeSpeaks) {
  const std::string obj = "mtllib model.mtl\nusemtl lamp\n" + std::string(square) + "f 1 2 3\nusemtl wall\nf 1 3 4\n";
  write("model.mtl", "newmtl lamp\nKa 20 20 20\nKd 1 1 1\nnewmtl wall\nKa 1 1 1\nKd 1 1 1\n");
  const auto loaded = read(obj);
  expect_one_warning(loaded, "taken for emitted radiance");
  EXPECT_EQ(loaded.scene.materials[0].emission, Rgb(20));
  EXPECT_FALSE(loaded.scene.materials[1].emits());
  write("model.mtl", "newmtl lamp\nKa 20 20 20\nKd 1 1 1\nnewmtl wall\nKe 1 1 1\nKd 1 1 1\n");
  EXPECT_FALSE(read_quietly(obj).materials[0].emits());
}

TEST_F(ObjReader, TexturesAreLoadedOnceAndTheirOptionsHeeded) {
  const auto png = encode_png({2, 1, 3, {255, 0, 0, 0, 255, 0}});
  write("a b.png", {reinterpret_cast<const char*>(png.data()), png.size()});
  write("model.mtl", "newmtl m\nmap_Kd -s 2 4 -o 0.5 0.25 -bm 1 a b.png\nnewmtl n\nKd 0.5 0.5 0.5\nmap_Kd a b.png\n");
  const Scene scene = read_quietly("mtllib model.mtl\nusemtl m\n" + std::string(square) +
                                   "vt 0 0\nf 1/1 2/1 3/1\nusemtl n\nf 1/1 3/1 4/1\n");
  ASSERT_EQ(scene.images.size(), 1U);
  EXPECT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.images[0].width, 2);
  EXPECT_EQ(scene.materials[0].base_colour, Rgb(1.0F));
  EXPECT_EQ(scene.materials[1].base_colour, Rgb(0.5F));
  // OBJ (u, v) = (0.3, 0.2) upwards lies at (0.5 + 2 * 0.3, 0.25 + 4 * 0.2) = (1.1, 1.05); downwards v is 1 - that.
  const Vec3f at = scene.materials[0].base_colour_texture.value().transform * Vec3f(0.3F, 1 - 0.2F, 1);
  EXPECT_NEAR(at.x, 1.1F, 1e-6F);
  EXPECT_NEAR(at.y, 1 - 1.05F, 1e-6F);
}

TEST_F(ObjReader, AMissingTextureIsAWarning) {
  write("model.mtl", "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd none.png\nmap_Ke none.png\nKe 1 1 1\n");
  const auto loaded = read("mtllib model.mtl\nusemtl m\n" + std::string(square) + "f 1 2 3\n");
  expect_one_warning(loaded, "none.png: no such file");
  EXPECT_FALSE(loaded.scene.materials[0].base_colour_texture.has_value());
  EXPECT_EQ(loaded.scene.materials[0].emission, Rgb(1));
}

TEST_F(ObjReader, MtlErrorsNameTheMtlAndItsLine) {
  for (const char* mtl :
       {"newmtl m\nKd 1 x 0\n", "newmtl m\nNs nan\n", "newmtl m\nKd\n", "\nKd 1 1 1\n", "newmtl m\nmap_Kd\n"}) {
    write("model.mtl", mtl);
    try {
      static_cast<void>(read("mtllib model.mtl\n" + std::string(square) + "f 1 2 3\n"));
      ADD_FAILURE() << mtl;
    } catch (const FileError& error) {
      EXPECT_EQ(error.path(), (folder_ / "model.mtl").string());
      EXPECT_EQ(error.place(), "line 2") << error.what();
    }
  }
}

// Damage of any kind is read as something or refused as a FileError.
TEST_F(ObjReader, DamagedFilesLoadOrAreFileErrors) {
  const std::string obj = "mtllib model.mtl\no box\n" + std::string(square) +
                          "v 0 0 1\nvt 0 0\nvt 1 1\nvn 0 0 1\nvn 1 0 0\nusemtl m\nf 1/1/1 2/2/1 3/1/2 4/2/2\ng side\n"
                          "usemtl n\nf -1//1 -2//2 -3//1\nf 1 2 5 \\\n 4\ns 1\nl 1 2\n";
  const std::string mtl =
      "newmtl m\nKd 0.5 0.25 1\nKs 0.1 0.1 0.1\nNs 20\nillum 2\nmap_Kd -s 1 2 a.png\nnewmtl n\nKe 1 2 3\nd 0.5\nNi "
      "1.5\nTf 1 1 1\n";
  CounterRng rng(17);
  const auto damaged = [&rng](std::string text, int trial) {
    if (trial % 3 == 0) text.resize(static_cast<std::size_t>(rng.next() * static_cast<double>(text.size())));
    static constexpr std::string_view likely = "0123456789-/.e \n\\#vftnomgusNdK\xff";
    for (int n = 0; n < trial % 5 && !text.empty(); ++n) {
      text[static_cast<std::size_t>(rng.next() * static_cast<double>(text.size()))] =
          trial % 2 == 0 ? static_cast<char>(rng.next_bits())
                         : likely[static_cast<std::size_t>(rng.next() * static_cast<double>(likely.size()))];
    }
    return text;
  };
  int read_well = 0;
  int refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    if (trial % 4 == 0) write("model.mtl", damaged(mtl, trial / 4));
    if (trial % 4 == 1) write("model.mtl", mtl);
    try {
      const auto loaded = read(trial % 4 == 0 ? obj : damaged(obj, trial));
      EXPECT_GT(loaded.scene.triangle_count(), 0U);
      ++read_well;
    } catch (const FileError& error) {
      EXPECT_FALSE(error.path().empty());
      ++refused;
    }
  }
  EXPECT_GT(read_well, 40);
  EXPECT_GT(refused, 40);
}

}  // namespace
}  // namespace penumbra
