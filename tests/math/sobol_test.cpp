#include "penumbra/math/sobol.h"

#include <gtest/gtest.h>

#include <set>

namespace penumbra {
namespace {

TEST(Sobol, FirstPointsAreTheKnownOnes) {
  // Sobol sequence in Gray-free order: 0, 1/2, 1/4, 3/4 in the first two dimensions (Joe & Kuo 2008).
  const double first[4][2] = {{0, 0}, {0.5, 0.5}, {0.25, 0.75}, {0.75, 0.25}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    for (int d = 0; d < 2; ++d) EXPECT_EQ(sobol_bits(i, d) * 0x1p-32, first[i][d]);
  }
}

TEST(Sobol, EveryDimensionStratifiesEveryPowerOfTwo) {
  for (int d = 0; d < sobol_dimensions; ++d) {
    std::set<std::uint32_t> strata;
    for (std::uint32_t i = 0; i < 256; ++i) strata.insert(sobol_bits(i, d) >> 24);
    EXPECT_EQ(strata.size(), 256U);
  }
}

// A (0,2)-sequence puts one of its first 2^m points in each elementary interval of area 2^-m; scrambling keeps that.
TEST(Sobol, ScrambledPairsFormANet) {
  for (std::uint64_t key = 0; key < 20; ++key) {
    for (int across = 0; across <= 6; ++across) {
      std::set<int> cells;
      for (std::uint32_t i = 0; i < 64; ++i) {
        const Vec2d p = owen_sobol_2d(i, key);
        const int columns = 1 << across;
        const int rows = 1 << (6 - across);
        cells.insert(static_cast<int>(p.x * columns) * rows + static_cast<int>(p.y * rows));
      }
      EXPECT_EQ(cells.size(), 64U) << "key " << key << ", " << (1 << across) << " columns";
    }
  }
}

TEST(Sobol, ScrambledMeanOfASmoothFunctionConvergesFasterThanRandom) {
  // int x^2 y over the square = 1/6; random points would have an RMS error near 2.4e-3 at 4096 points.
  double squared = 0;
  for (std::uint64_t key = 0; key < 16; ++key) {
    double sum = 0;
    for (std::uint32_t i = 0; i < 4096; ++i) {
      const Vec2d p = owen_sobol_2d(i, key * 977);
      sum += p.x * p.x * p.y;
    }
    squared += (sum / 4096 - 1.0 / 6) * (sum / 4096 - 1.0 / 6) / 16;
  }
  EXPECT_LT(squared, 1e-5 * 1e-5);
}

}  // namespace
}  // namespace penumbra
