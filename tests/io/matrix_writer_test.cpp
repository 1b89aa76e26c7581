#include "penumbra/io/matrix_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/temporary_file.h"
#include "penumbra/file/file_error.h"
#include "penumbra/io/triplet_spill.h"
#include "penumbra/io/vtk_writer.h"
#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

class MatrixWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("penumbra-matrix-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // 3 rows: [0 .25 .5], [], [1 0 0].
  fs::path write(const std::string& name, bool partial = false) {
    const fs::path path = folder_ / name;
    auto writer = make_matrix_writer(path);
    const std::vector<std::uint32_t> c0{1, 2}, c2{0};
    const std::vector<double> v0{0.25, 0.5}, v2{1};
    writer->add_row(c0, v0);
    writer->add_row({}, {});
    writer->add_row(c2, v2);
    writer->finish({{1.5, 2, 3}, {"floor, old", "w\xc3\xa4nde", "roof"}, partial});
    return path;
  }

  fs::path folder_;
};

template <class T>
T field(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// The members of an archive of stored files, by its directory (PKWARE APPNOTE 4.3.12), checksums verified bit by bit.
std::map<std::string, std::string> unzip(const std::string& bytes) {
  std::map<std::string, std::string> members;
  const std::size_t end = bytes.rfind("PK\5\6");
  EXPECT_NE(end, std::string::npos);
  std::size_t at = field<std::uint32_t>(bytes, end + 16);
  for (int count = field<std::uint16_t>(bytes, end + 10); count > 0; --count) {
    EXPECT_EQ(field<std::uint32_t>(bytes, at), 0x02014b50U);
    const auto size = field<std::uint32_t>(bytes, at + 24), offset = field<std::uint32_t>(bytes, at + 42);
    const auto name_size = field<std::uint16_t>(bytes, at + 28), extra = field<std::uint16_t>(bytes, at + 30);
    const std::string name = bytes.substr(at + 46, name_size);
    const std::size_t data =
        offset + 30U + field<std::uint16_t>(bytes, offset + 26) + field<std::uint16_t>(bytes, offset + 28);
    members[name] = bytes.substr(data, size);
    std::uint32_t crc = 0xFFFFFFFFU;
    for (const char c : members[name]) {
      crc ^= static_cast<unsigned char>(c);
      for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (0xEDB88320U & (0U - (crc & 1U)));
    }
    EXPECT_EQ(~crc, field<std::uint32_t>(bytes, at + 16)) << name;
    at += 46U + name_size + extra;
  }
  return members;
}

struct Npy {
  std::string header, data;
};
Npy npy(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const auto size = field<std::uint16_t>(bytes, 8);
  EXPECT_EQ((10U + size) % 64, 0U);
  return {bytes.substr(10, size), bytes.substr(10U + size)};
}

TEST_F(MatrixWriterTest, NpzHoldsWhatScipyLooksFor) {
  const auto members = unzip(test::file_bytes(write("f.npz")));
  for (const char* name : {"data", "indices", "indptr", "shape", "format", "area", "name", "partial"}) {
    ASSERT_EQ(members.count(std::string(name) + ".npy"), 1U) << name;
  }
  const Npy data = npy(members.at("data.npy")), indices = npy(members.at("indices.npy"));
  EXPECT_NE(data.header.find("'<f8'"), std::string::npos);
  EXPECT_NE(data.header.find("(3,)"), std::string::npos);
  EXPECT_EQ(field<double>(data.data, 8), 0.5);
  EXPECT_EQ(field<std::int32_t>(indices.data, 4), 2);
  const Npy offsets = npy(members.at("indptr.npy"));
  EXPECT_EQ(field<std::int64_t>(offsets.data, 16), 2);
  EXPECT_EQ(field<std::int64_t>(offsets.data, 24), 3);
  EXPECT_EQ(npy(members.at("format.npy")).data, "csr");
  const Npy names = npy(members.at("name.npy"));
  EXPECT_NE(names.header.find("'<U10'"), std::string::npos);
  EXPECT_EQ(names.data.size(), 3U * 10 * 4);
  EXPECT_EQ(field<char32_t>(names.data, 4 * 11), U'\u00e4');
  EXPECT_EQ(npy(members.at("partial.npy")).data, std::string(1, '\0'));
  EXPECT_EQ(npy(unzip(test::file_bytes(write("p.npz", true))).at("partial.npy")).data, "\1");
}

TEST_F(MatrixWriterTest, MatrixMarketCountsFromOne) {
  const std::string text = test::file_bytes(write("f.mtx"));
  EXPECT_EQ(text.rfind("%%MatrixMarket matrix coordinate real general\n", 0), 0U);
  EXPECT_NE(text.find("\n3 3 3\n1 2 0.25\n1 3 0.5\n3 1 1\n"), std::string::npos) << text;
}

TEST_F(MatrixWriterTest, CsvQuotesNames) {
  EXPECT_EQ(test::file_bytes(write("f.csv")),
            "i,j,from,to,area,factor\n0,1,\"floor, old\",w\xc3\xa4nde,1.5,0.25\n0,2,\"floor, old\",roof,1.5,0.5\n"
            "2,0,roof,\"floor, old\",3,1\n");
}

TEST_F(MatrixWriterTest, LeavesNothingWhenNotFinished) {
  {
    auto writer = make_matrix_writer(folder_ / "half.npz");
    const std::vector<std::uint32_t> c{0};
    const std::vector<double> v{1};
    writer->add_row(c, v);
  }
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_THROW((void)make_matrix_writer(folder_ / "f.txt"), FileError);
  EXPECT_THROW((void)make_matrix_writer(folder_ / "none" / "f.npz"), FileError);
}

// Whatever fits in memory and whatever has to wait on disk: the same rows as a dense matrix added up.
TEST_F(MatrixWriterTest, SpilledTripletsComeBackInOrder) {
  constexpr std::size_t rows = 300;
  std::vector<double> dense(rows * rows, 0.0);
  TripletSpill spill(folder_ / "f.npz", rows, 1);
  CounterRng rng(5);
  for (int k = 0; k < 50000; ++k) {
    const auto i = static_cast<std::uint32_t>(rng.next_bits() % rows),
               j = static_cast<std::uint32_t>(rng.next_bits() % rows);
    const double value = rng.next();
    dense[i * rows + j] += value;
    spill.add({i, j, value});
  }
  EXPECT_GT(spill.bytes_on_disk(), 0U);
  EXPECT_TRUE(fs::is_empty(folder_));  // nameless
  std::size_t next = 0;
  spill.for_each_row([&](std::size_t row, std::span<const std::uint32_t> columns, std::span<const double> values) {
    EXPECT_EQ(row, next++);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      EXPECT_TRUE(k == 0 || columns[k] > columns[k - 1]);
      EXPECT_EQ(values[k], dense[row * rows + columns[k]]);  // added in the same order: the same bits
      dense[row * rows + columns[k]] = 0;
    }
  });
  EXPECT_EQ(next, rows);
  for (const double left : dense) EXPECT_EQ(left, 0);
}

TEST_F(MatrixWriterTest, VtuNamesEveryArrayAndCell) {
  PolygonCells cells;
  cells.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  cells.corners = {0, 1, 2, 0, 2, 3};
  cells.offsets = {3, 6};
  cells.values = {{"row sum", {0.5, 1}}, {"a<b", {1, 2}}};
  write_vtu(folder_ / "f.vtu", cells);
  const std::string text = test::file_bytes(folder_ / "f.vtu");
  EXPECT_NE(text.find("NumberOfPoints=\"4\" NumberOfCells=\"2\""), std::string::npos);
  EXPECT_NE(text.find("Name=\"row sum\""), std::string::npos);
  EXPECT_NE(text.find("Name=\"a&lt;b\""), std::string::npos);
  EXPECT_NE(text.find("Name=\"offsets\" format=\"ascii\">\n3\n6\n"), std::string::npos);
  EXPECT_NE(text.find("</VTKFile>"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
