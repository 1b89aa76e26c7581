#include "penumbra/io/vdb_grid.h"

#include <gtest/gtest.h>

#include <string>

#include "io/temporary_file.h"
#include "penumbra/file/file_error.h"
#include "penumbra/io/density_grid_reader.h"
#include "test_paths.h"

namespace penumbra {
namespace {

// ramp.vdb, written by OpenVDB 10.0: a grid "temperature" that is no density, and "density" with voxels of 0.5 m at
// x = -1 .. 1, y = 0 .. 3, z = 2 .. 3, of 1 + 0.25 x + 0.5 y + 2 z.
TEST(VdbGrid, ReadsVoxelsWhereTheyAre) {
  if (!reads_vdb()) {
    EXPECT_THROW((void)read_vdb_grid(PENUMBRA_TEST_DATA "/ramp.vdb"), FileError);
    return;
  }
  const DensityGrid grid = read_vdb_grid(PENUMBRA_TEST_DATA "/ramp.vdb");
  EXPECT_EQ(grid.cells, (std::array<std::uint32_t, 3>{3, 4, 2}));
  EXPECT_EQ(grid.box.lower, Vec3d(-0.75, -0.25, 0.75));
  EXPECT_EQ(grid.box.upper, Vec3d(0.75, 1.75, 1.75));
  ASSERT_EQ(grid.values.size(), 24U);
  std::size_t at = 0;
  for (const float x : {-1.0F, 0.0F, 1.0F})
    for (const float y : {0.0F, 1.0F, 2.0F, 3.0F})
      for (const float z : {2.0F, 3.0F}) EXPECT_FLOAT_EQ(grid.values[at++], 1 + 0.25F * x + 0.5F * y + 2 * z);
}

TEST(VdbGrid, WhatIsNoneIsRefusedInASentence) {
  const test::TemporaryFile file("no volume", ".vdb");
  try {
    (void)read_vdb_grid(file.path());
    FAIL();
  } catch (const FileError& e) {
    const std::string said = e.what();
    EXPECT_NE(said.find(reads_vdb() ? "cannot be read as OpenVDB" : "install libopenvdb-dev"), std::string::npos)
        << said;
  }
}

}  // namespace
}  // namespace penumbra
