#include "penumbra/io/density_grid_reader.h"

#include <gtest/gtest.h>

#include "io/temporary_file.h"
#include "penumbra/file/file_error.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/gltf_reader.h"
#include "penumbra/io/gltf_writer.h"
#include "penumbra/io/npy_array.h"
#include "penumbra/io/zip_writer.h"
#include "penumbra/scene/builtin_scenes.h"

namespace penumbra {
namespace {

std::string array_of(const std::string& type, const std::string& shape, const std::vector<float>& values) {
  std::string bytes = npy_header(type, shape);
  if (type == "<f4") {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  } else {
    const std::vector<double> wide(values.begin(), values.end());
    bytes.append(reinterpret_cast<const char*>(wide.data()), wide.size() * sizeof(double));
  }
  return bytes;
}

using Members = std::vector<std::pair<std::string, std::string>>;

/// An .npz of the given arrays that goes away with its object.
class Archive {
 public:
  explicit Archive(const Members& members) : file_("", ".npz") {
    OutputFile out(file_.path());
    ZipWriter zip(out);
    for (const auto& [name, bytes] : members) zip.add(name + ".npy", bytes);
    zip.finish();
    out.commit();
  }
  [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }

 private:
  test::TemporaryFile file_;
};

const std::string unit_box = array_of("<f8", "(2, 3)", {0, 0, 0, 1, 2, 3});
const std::string six = array_of("<f4", "(1, 2, 3)", {0, 1, 2, 3, 4, 5});

std::string message(const Members& members) {
  try {
    const Archive archive(members);
    (void)read_density_grid(archive.path());
  } catch (const FileError& e) {
    return e.what();
  }
  return "";
}

TEST(DensityGridReader, ReadsWhatNumPyWrites) {
  const Archive archive({{"density", six},
                         {"bounds", unit_box},
                         {"absorption", array_of("<f8", "(3,)", {1, 2, 3})},
                         {"g", array_of("<f8", "()", {0.5F})}});
  const Medium smoke = read_density_grid(archive.path());
  ASSERT_TRUE(smoke.density);
  EXPECT_EQ(smoke.density->cells, (std::array<std::uint32_t, 3>{1, 2, 3}));
  EXPECT_EQ(smoke.density->values, (std::vector<float>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(smoke.density->box.upper, Vec3d(1, 2, 3));
  EXPECT_EQ(smoke.absorption, Rgb(1, 2, 3));
  EXPECT_EQ(smoke.scattering, Rgb(0.8F));
  EXPECT_EQ(smoke.asymmetry, 0.5F);
}

TEST(DensityGridReader, WhatIsWrongIsSaid) {
  EXPECT_NE(message({{"density", six}}).find("bounds"), std::string::npos);
  EXPECT_NE(message({{"density", array_of("<f4", "(6,)", {0, 1, 2, 3, 4, 5})}, {"bounds", unit_box}}).find("three"),
            std::string::npos);
  EXPECT_NE(message({{"density", array_of("<f4", "(1, 1, 1)", {-1})}, {"bounds", unit_box}}).find("below 0"),
            std::string::npos);
  EXPECT_NE(message({{"density", six}, {"bounds", array_of("<f8", "(2, 3)", {0, 0, 0, 1, 0, 1})}}).find("upper corner"),
            std::string::npos);
  EXPECT_NE(message({{"density", six}, {"bounds", unit_box}, {"g", array_of("<f8", "(1,)", {1})}}).find("between"),
            std::string::npos);
  EXPECT_THROW((void)read_density_grid("smoke.obj"), FileError);
  EXPECT_THROW((void)read_density_grid("missing.npz"), FileError);
}

// Two gibibytes of nothing deflate to two megabytes: the archive's directory tells before they are unpacked.
TEST(DensityGridReader, GridsThatAreTooLargeAreRefusedBeforeTheyAreUnpacked) {
  const Archive archive({{"density", six}, {"bounds", unit_box}});
  std::string bytes = test::file_bytes(archive.path());
  const std::size_t directory = bytes.find("PK\x01\x02");
  bytes.replace(directory + 24, 4, "\xff\xff\xff\x7f");
  const test::TemporaryFile bomb(bytes, ".npz");
  try {
    (void)read_density_grid(bomb.path());
    FAIL();
  } catch (const FileError& e) {
    EXPECT_NE(std::string(e.what()).find("1 GiB"), std::string::npos) << e.what();
  }
}

TEST(DensityGridReader, VdbIsReadOrRefusedByItsName) {
  const test::TemporaryFile nonsense("no grid", ".vdb");
  try {
    (void)read_density_grid(nonsense.path());
    FAIL() << "read nonsense";
  } catch (const FileError& e) {
    EXPECT_NE(std::string(e.what()).find(reads_vdb() ? "OpenVDB" : "built without OpenVDB"), std::string::npos);
  }
}

// Fog, smoke and the sun's disk come back from a .glb as they were.
TEST(DensityGridReader, MediaComeBackFromGltf) {
  const test::TemporaryFile file("", ".glb");
  const Scene smoke = make_builtin_scene("smoke?cells=12");
  (void)write_glb(file.path(), smoke);
  const Scene back = read_gltf(file.path()).scene;
  ASSERT_EQ(back.air.size(), std::size_t{1});
  const Medium& a = smoke.media[smoke.air[0]];
  const Medium& b = back.media[back.air[0]];
  ASSERT_TRUE(b.density);
  EXPECT_EQ(b.density->values, a.density->values);
  EXPECT_EQ(b.density->cells, a.density->cells);
  EXPECT_EQ(b.density->box.lower, a.density->box.lower);
  EXPECT_EQ(b.density->box.upper, a.density->box.upper);
  EXPECT_EQ(b.scattering, a.scattering);
  EXPECT_EQ(b.absorption, a.absorption);
  EXPECT_EQ(b.asymmetry, a.asymmetry);
  EXPECT_EQ(b.name, "smoke");
  EXPECT_EQ(std::get<DirectionalLight>(back.lights[0].kind).angular_radius,
            std::get<DirectionalLight>(smoke.lights[0].kind).angular_radius);

  Scene milk = make_builtin_scene("cornell-spheres");
  milk.media.push_back({.name = "milk", .absorption = Rgb(0.5F), .scattering = Rgb(20, 21, 22), .asymmetry = 0.25F});
  milk.materials.back().medium = 0;
  (void)write_glb(file.path(), milk);
  const Scene again = read_gltf(file.path()).scene;
  ASSERT_TRUE(again.materials.back().medium);
  EXPECT_EQ(again.media[*again.materials.back().medium].scattering, Rgb(20, 21, 22));
  EXPECT_FALSE(again.media[*again.materials.back().medium].box);
}

}  // namespace
}  // namespace penumbra
