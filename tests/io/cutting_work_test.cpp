#include "penumbra/io/cutting_work.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(CuttingWork, IsTheSquareOfLargePolygonsInAll) {
  CuttingWork work;
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(work.allows(8192)) << i;
  EXPECT_FALSE(work.allows(300));
  EXPECT_FALSE(CuttingWork().allows(100000));
}

TEST(CuttingWork, SmallPolygonsAreFree) {
  CuttingWork work;
  for (int i = 0; i < 100000; ++i) ASSERT_TRUE(work.allows(256)) << i;
  EXPECT_TRUE(work.allows(8192));
}

}  // namespace
}  // namespace penumbra
