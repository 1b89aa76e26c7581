#include "penumbra/radiosity/form_factors/normalization.h"

#include <gtest/gtest.h>

#include <cmath>

#include "penumbra/math/rng.h"
#include "penumbra/radiosity/form_factors/hemicube.h"
#include "penumbra/radiosity/form_factors/ray_cast.h"
#include "radiosity/view3d_cases.h"

namespace penumbra {
namespace {

// A noisy enclosure: rays scatter, so rows miss 1.
FactorMatrix noisy() {
  const PatchMesh mesh = test::read_case("box345_AB1.0.vs3");
  RayCastOptions options;
  options.rays = 256;
  return assemble_factor_matrix(*make_ray_cast(mesh, options), mesh);
}

double worst_row(const FactorMatrix& m) {
  double worst = 0;
  for (std::size_t i = 0; i < m.rows(); ++i) worst = std::max(worst, std::abs(m.row_sum(i) - 1));
  return worst;
}

double worst_reciprocity(const FactorMatrix& m) {
  double worst = 0;
  for (std::size_t i = 0; i < m.rows(); ++i) {
    for (const std::uint32_t j : m.row_columns(i)) {
      worst = std::max(worst, std::abs(m.areas[i] * m.at(i, j) - m.areas[j] * m.at(j, i)));
    }
  }
  return worst;
}

TEST(Normalization, RowsSumToOneAndLoseReciprocity) {
  FactorMatrix m = noisy();
  const double before = worst_row(m);
  EXPECT_GT(before, 1e-4);
  const Normalization report = normalize_rows(m);
  EXPECT_LT(worst_row(m), 1e-14);
  EXPECT_DOUBLE_EQ(report.largest_defect, before);
  EXPECT_NEAR(report.largest_row_change, before, 1e-12);
  EXPECT_GT(worst_reciprocity(m), 1e-6);
}

TEST(Normalization, LeastSquaresKeepsReciprocityAndSigns) {
  FactorMatrix m = noisy();
  const double before = worst_row(m);
  const Normalization report = normalize_least_squares(m);
  EXPECT_LT(worst_row(m), 1e-9);
  EXPECT_LT(worst_reciprocity(m), 1e-14);
  EXPECT_GT(report.largest_change, 0);
  EXPECT_LT(report.largest_row_change, 3 * before);
  for (const double f : m.values) EXPECT_GE(f, 0);
}

// Of the corrections with the right sums none is smaller: moving along any cycle i-j-k-l, which keeps all sums, does
// not lower the weighted square.
TEST(Normalization, LeastSquaresIsLeast) {
  FactorMatrix before = noisy();
  FactorMatrix m = before;
  normalize_least_squares(m);
  const auto relative = [&](std::size_t i, std::size_t j) {
    const double x = before.areas[i] * before.at(i, j);
    return (m.areas[i] * m.at(i, j) - x) / (x * x);
  };
  CounterRng rng(3);
  int cycles = 0;
  for (int k = 0; k < 20000 && cycles < 200; ++k) {
    std::size_t v[4];
    for (std::size_t& x : v) x = rng.next_bits() % m.rows();
    if (!(before.at(v[0], v[1]) > 0 && before.at(v[1], v[2]) > 0 && before.at(v[2], v[3]) > 0 &&
          before.at(v[3], v[0]) > 0)) {
      continue;
    }
    const double slope = relative(v[0], v[1]) - relative(v[1], v[2]) + relative(v[2], v[3]) - relative(v[3], v[0]);
    const double size = std::abs(relative(v[0], v[1])) + std::abs(relative(v[1], v[2]));
    EXPECT_NEAR(slope, 0, 1e-6 * (1 + size));
    ++cycles;
  }
  EXPECT_GE(cycles, 50);
}

TEST(Normalization, APerfectMatrixStaysAsItIs) {
  const PatchMesh mesh = test::read_case("box345_none.vs3");
  HemicubeOptions options;
  options.exact_within = 1e9;
  options.resolution = 16;
  FactorMatrix m = assemble_factor_matrix(*make_hemicube(mesh, options), mesh);
  EXPECT_LT(normalize_least_squares(m).largest_change, 1e-9);
  EXPECT_LT(normalize_rows(m).largest_change, 1e-9);
}

}  // namespace
}  // namespace penumbra
