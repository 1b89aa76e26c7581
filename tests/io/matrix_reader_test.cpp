#include "penumbra/io/matrix_reader.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/temporary_file.h"
#include "penumbra/file/file_error.h"
#include "penumbra/io/csv_table.h"
#include "penumbra/io/matrix_writer.h"
#include "test_paths.h"

namespace penumbra {
namespace {

using test::file_bytes;
using test::TemporaryFile;

const std::string data = PENUMBRA_TEST_DATA "/radiosity/";

/// The matrix as full rows.
std::vector<std::vector<double>> dense(const MatrixFile& m) {
  std::vector<std::vector<double>> rows(m.rows(), std::vector<double>(m.rows(), 0.0));
  for (std::size_t i = 0; i < m.rows(); ++i)
    for (std::uint64_t k = m.offsets[i]; k < m.offsets[i + 1]; ++k) rows[i][m.columns[k]] = m.values[k];
  return rows;
}

using Rows = std::vector<std::vector<double>>;
const Rows three{{0, 0.25, 0.75}, {0.5, 0, 0.5}, {0.75, 0.25, 0}};

// Whatever the writer writes, the reader reads, to the last bit.
TEST(MatrixReader, ReadsBackWhatTheWriterWrites) {
  for (const std::string extension : {".npz", ".mtx", ".csv"}) {
    for (const bool partial : {false, true}) {
      const TemporaryFile file("", extension);
      const auto writer = make_matrix_writer(file.path());
      const Rows rows{{0, 1.0 / 3, 2.0 / 3}, {0.1, 0, 1e-300}, {0.7, 0, 0}};
      writer->add_row(std::vector<std::uint32_t>{1, 2}, std::vector<double>{rows[0][1], rows[0][2]});
      writer->add_row(std::vector<std::uint32_t>{0, 2}, std::vector<double>{rows[1][0], rows[1][2]});
      writer->add_row(std::vector<std::uint32_t>{0}, std::vector<double>{rows[2][0]});
      const std::vector<std::string> names{"floor, old", "w\xc3\xa4nde \"A\"", "\xf0\x9f\x8f\xa0 roof"};
      writer->finish({{1.5, 0.1, 3}, names, partial});
      const MatrixFile read = read_matrix(file.path());
      EXPECT_EQ(dense(read), rows) << extension;
      EXPECT_EQ(read.areas, (std::vector<double>{1.5, 0.1, 3})) << extension;
      EXPECT_EQ(read.names, names) << extension;
      EXPECT_EQ(read.partial, partial) << extension;
    }
  }
}

// The layout of numpy's savez_compressed: deflated members with 64-bit local heads.
TEST(MatrixReader, ReadsCompressedRowsAndCoordinates) {
  EXPECT_EQ(dense(read_matrix(data + "csr_deflated.npz")), three);
  EXPECT_EQ(dense(read_matrix(data + "coo_deflated.npz")), three);  // one entry in two halves
  EXPECT_TRUE(read_matrix(data + "csr_deflated.npz").areas.empty());
}

TEST(MatrixReader, ReadsMatrixMarketOfOthers) {
  const TemporaryFile symmetric(
      "%%MatrixMarket matrix coordinate real symmetric\n% a comment\n3 3 2\n2 1 0.25\n3 1 0.75\n", ".mtx");
  EXPECT_EQ(dense(read_matrix(symmetric.path())), (Rows{{0, 0.25, 0.75}, {0.25, 0, 0}, {0.75, 0, 0}}));
  const TemporaryFile array("%%MatrixMarket matrix array real general\n2 2\n0\n1\n0.5\n0\n", ".mtx");
  EXPECT_EQ(dense(read_matrix(array.path())), (Rows{{0, 0.5}, {1, 0}}));
}

// No cut and no flipped byte of an archive may do more than raise a FileError.
TEST(MatrixReader, DamagedArchivesAreRefusedOrReadNeverMore) {
  const std::string whole = file_bytes(data + "csr_deflated.npz");
  for (std::size_t size = 0; size < whole.size(); size += 3) {
    const TemporaryFile cut(whole.substr(0, size), ".npz");
    EXPECT_THROW((void)read_matrix(cut.path()), FileError) << size;
  }
  std::size_t refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x41);
    const TemporaryFile file(damaged, ".npz");
    try {
      EXPECT_EQ(dense(read_matrix(file.path())), three) << at;  // a byte that nobody reads, such as the date
    } catch (const FileError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, whole.size() / 3);
}

TEST(MatrixReader, RefusesWhatIsNoMatrixOfFactors) {
  const std::vector<std::pair<std::string, std::string>> bad{
      {".npz", "hello"},
      {".npz", ""},
      {".mtx", "3 3 1\n1 1 1\n"},
      {".mtx", "%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0\n"},
      {".mtx", "%%MatrixMarket matrix coordinate real general\n2 3 1\n1 1 1\n"},
      {".mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n"},
      {".mtx", "%%MatrixMarket matrix coordinate real general\n2 2 1\n3 1 1\n"},
      {".mtx", "%%MatrixMarket matrix coordinate real general\n4000000000 4000000000 1\n1 1 1\n"},
      {".mtx", "%%MatrixMarket matrix array real general\n100000 100000\n1\n"},
      {".mtx", "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 -0.5\n"},
      {".csv", "i,j\n0,1\n"},
      {".csv", "i,j,factor\n0,1,nan\n"},
      {".csv", "i,j,factor\n0,99999999999,0.5\n"},
      {".csv", "i,j,factor\n0,1\n"},
      {".csv", "i,j,factor\n\"0,1,0.5\n"},
      {".txt", "0 1\n"},
  };
  for (const auto& [extension, text] : bad) {
    const TemporaryFile file(text, extension);
    EXPECT_THROW((void)read_matrix(file.path()), FileError) << text;
  }
}

TEST(CsvTable, UnderstandsQuotesLineEndsAndBlanks) {
  const TemporaryFile file("\xEF\xBB\xBF# made by hand\r\nname , value\r\n\r\n \"a, \"\"b\"\"\n c\" , 2 \r\nd,-1e3",
                           ".csv");
  const CsvTable table = read_csv_table(file.path());
  EXPECT_EQ(table.columns, (std::vector<std::string>{"name", "value"}));
  ASSERT_EQ(table.rows.size(), std::size_t{2});
  EXPECT_EQ(table.rows[0].words[0], "a, \"b\"\n c");
  EXPECT_EQ(table.number(table.rows[0], 1), 2);
  EXPECT_EQ(table.number(table.rows[1], 1), -1000);
  EXPECT_EQ(table.rows[1].line, std::size_t{6});
  EXPECT_EQ(csv_word(table.rows[0].words[0]), "\"a, \"\"b\"\"\n c\"");
}

}  // namespace
}  // namespace penumbra
