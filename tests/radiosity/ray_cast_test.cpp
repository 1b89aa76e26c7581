#include "penumbra/radiosity/form_factors/ray_cast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "radiosity/view3d_cases.h"

namespace penumbra {
namespace {

using test::read_case;
using test::reference_matrix;

double row_error(const std::vector<RayCastFactor>& row, const std::vector<double>& truth) {
  std::vector<double> estimate(truth.size(), 0.0);
  for (const RayCastFactor& f : row) estimate[f.patch] = f.factor;
  double sum = 0;
  for (std::size_t j = 0; j < truth.size(); ++j) sum += (estimate[j] - truth[j]) * (estimate[j] - truth[j]);
  return sum;
}

// Slope of the root mean square error against the number of rays, on logarithms, over powers of four.
double convergence(const PatchMesh& mesh, const std::vector<std::vector<double>>& truth, int least, int most,
                   std::uint32_t stride, std::uint64_t seeds) {
  const RayCaster caster(mesh);
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int power = least; power <= most; power += 2) {
    double square = 0;
    for (std::uint32_t p = 0; p < mesh.radiating_count; p += stride) {
      for (std::uint64_t seed = 0; seed < seeds; ++seed) square += row_error(caster.row(p, 1 << power, seed), truth[p]);
    }
    const double x = power * std::log(2.0), y = 0.5 * std::log(square);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

// Few rays: most factors have a handful of hits. Many: the scrambles' scatter decides.
TEST(RayCast, ErrorsLieWithinThreeStandardErrorsWhateverTheSeed) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const auto truth = reference_matrix("box345_AB1.0_F.csv", mesh.surface_count());
  const RayCaster caster(mesh);
  for (const int rays : {1 << 8, 1 << 10, 1 << 12}) {
    for (const std::uint64_t seed : {0U, 7U, 2026U}) {
      double inside = 0, all = 0, square = 0, said = 0;
      for (std::uint32_t p = 0; p < mesh.radiating_count; ++p) {
        for (const RayCastFactor& f : caster.row(p, rays, seed)) {
          const double error = f.factor - truth[p][f.patch];
          inside += std::abs(error) <= 3 * f.standard_error ? 1 : 0;
          all += 1, square += error * error, said += f.standard_error * f.standard_error;
        }
      }
      EXPECT_GE(inside, 0.99 * all) << rays << " rays, seed " << seed;
      EXPECT_LE(std::sqrt(said / square), 1.35) << rays << " rays, seed " << seed;  // they do not buy this by size
    }
  }
}

TEST(RayCast, ConvergesFasterThanRandomPoints) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const auto truth = reference_matrix("box345_AB1.0_F.csv", mesh.surface_count());
  EXPECT_LT(convergence(mesh, truth, 8, 14, 6, 1), -0.58);
}

TEST(RayCast, ConvergesAsPromisedOverTenDoublingsSlow) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const auto truth = reference_matrix("box345_AB1.0_F.csv", mesh.surface_count());
  const double slope = convergence(mesh, truth, 8, 18, 6, 1);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_LT(slope, -0.58);
}

TEST(RayCast, EveryRayInAClosedRoomArrives) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const RayCaster caster(mesh);
  for (std::uint32_t p = 0; p < mesh.radiating_count; p += 7) {
    double sum = 0;
    for (const RayCastFactor& f : caster.row(p, 1 << 12, 1)) sum += f.factor;
    EXPECT_NEAR(sum, 1, 1e-3);
  }
}

TEST(RayCast, MatrixHoldsReciprocityAndTheReference) {
  const PatchMesh mesh = read_case("facet.vs3");
  RayCastOptions options;
  options.rays = 1 << 13;
  const FactorMatrix m = assemble_factor_matrix(*make_ray_cast(mesh, options), mesh);
  // Opposite walls with the plate in between, semi-analytic: 0.115620602132415.
  EXPECT_NEAR(m.at(4, 5), 0.115620602132415, 2e-3);
  for (std::size_t i = 0; i < m.rows(); ++i) {
    EXPECT_EQ(m.at(i, i), 0);
    EXPECT_NEAR(m.row_sum(i), 1, m.row_errors[i]);
    for (std::size_t j = 0; j < m.rows(); ++j) EXPECT_NEAR(m.areas[i] * m.at(i, j), m.areas[j] * m.at(j, i), 1e-15);
  }
}

TEST(RayCast, ToleranceDecidesTheRays) {
  const PatchMesh mesh = read_case("l_room.vs3");
  const RayCaster caster(mesh);
  for (const double tolerance : {0.1, 0.03}) {
    RayCastOptions options;
    options.tolerance = tolerance;
    options.most_rays = 1 << 20;
    double error = 0;
    for (const RayCastFactor& f : caster.row(0, options)) error += 3 * f.standard_error;
    EXPECT_LE(error, tolerance);
  }
}

TEST(RayCast, ThreadedRunsGiveTheSameBits) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  RayCastOptions options;
  options.rays = 256;
  std::vector<double> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const auto m = assemble_factor_matrix(*make_ray_cast(mesh, options), mesh);
    if (first.empty()) first = m.values;
    EXPECT_EQ(first, m.values);
  }
}

TEST(RayCast, RefusesOptionsOutOfRange) {
  const PatchMesh mesh = read_case("facet.vs3");
  for (const int rays : {-1, 5}) {
    RayCastOptions options;
    options.rays = rays;
    EXPECT_THROW((void)make_ray_cast(mesh, options), std::invalid_argument);
  }
  RayCastOptions options;
  options.tolerance = 0;
  EXPECT_THROW((void)make_ray_cast(mesh, options), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
