#include "penumbra/radiosity/solvers/directional.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/solvers/direct.h"
#include "penumbra/radiosity/solvers/direction_bins.h"
#include "radiosity/enclosure_table.h"
#include "radiosity/enclosures.h"
#include "radiosity/round_cavities.h"

namespace penumbra {
namespace {

using test::element_mesh;
using test::enclosure_table;
using test::grid;

constexpr double pi = std::numbers::pi;

DirectionalProblem grey(std::size_t elements, double diffuse, double specular, double emission) {
  DirectionalProblem problem;
  problem.bands = 1;
  problem.diffuse.assign(elements, diffuse);
  problem.specular.assign(elements, specular);
  problem.emission.assign(elements, emission);
  return problem;
}

TEST(DirectionBins, IndexFindsTheBinOfEveryDirection) {
  const DirectionBins bins(5, 8);
  Dice dice(1);
  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    for (int k = 0; k < 20; ++k) {
      const Vec3d d = bins.direction(bin, dice.between(0.01, 0.99), dice.between(0.01, 0.99));
      EXPECT_EQ(bins.index(d), bin);
      EXPECT_EQ(bins.index({-d.x, -d.y, d.z}), bins.mirrored(bin));
    }
  }
}

TEST(DirectionBins, LobesAreReciprocalAndKeepEnergy) {
  const DirectionBins bins(4, 8);
  for (const double exponent : {0.0, 1.0, 20.0, 1e4}) {
    const std::vector<double> lobe = glossy_lobe(bins, exponent);
    const std::size_t n = bins.size();
    for (std::size_t i = 0; i < n; ++i) {
      double row = 0, column = 0;
      for (std::size_t j = 0; j < n; ++j) {
        row += lobe[i * n + j];
        column += lobe[j * n + i];
        EXPECT_NEAR(lobe[i * n + j], lobe[j * n + i], 1e-12);
      }
      EXPECT_NEAR(row, 1, 1e-11);
      EXPECT_NEAR(column, 1, 1e-11);
    }
    EXPECT_GT(lobe[bins.mirrored(3) * n + 3], exponent == 1e4 ? 1 - 1e-6 : 0);  // narrow: a mirror
  }
}

// A furnace stays one whatever its surfaces do with the light, as long as all reflect the same part of it.
TEST(DirectionalRadiosity, AFurnaceOfMirrorsLobesAndDiffusers) {
  const PatchMesh mesh = element_mesh(test::room_elements({1, 2, 1}, 2));
  DirectionalProblem problem = grey(mesh.surface_count(), 0.5, 0, 1);
  problem.exponent.assign(mesh.surface_count(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < mesh.surface_count(); ++i) {
    if (i % 3 == 0) continue;
    std::swap(problem.diffuse[i], problem.specular[i]);
    if (i % 3 == 1) problem.exponent[i] = 10;
  }
  DirectionalOptions options;
  options.tolerance = 1e-12;
  const auto solution = solve_directional(mesh, problem, options);
  EXPECT_TRUE(solution.converged);
  for (const double l : solution.radiance) EXPECT_NEAR(l, 2 / pi, 1e-9);
  for (const double h : solution.irradiance) EXPECT_NEAR(h, 2, 1e-9);
}

// Without mirrors it is radiosity.
TEST(DirectionalRadiosity, DiffuseSurfacesGiveTheRadiositySolution) {
  const PatchMesh mesh = element_mesh(test::room_elements({1, 1, 1}, 3));
  RadiosityProblem diffuse = test::uniform_problem(mesh.areas, 1, 0.5, 0);
  for (std::size_t i = 9; i < 18; ++i) diffuse.emission[i] = 1;
  const auto exact = solve_direct(diffuse, test::convex_factors(mesh));
  DirectionalProblem problem = grey(mesh.surface_count(), 0.5, 0, 0);
  problem.emission = diffuse.emission;
  const auto solution = solve_directional(mesh, problem);
  for (std::size_t i = 0; i < mesh.surface_count(); ++i) {
    EXPECT_NEAR(solution.radiosity[i], exact.radiosity[i], 0.03 * exact.radiosity[i]);
  }
  EXPECT_NEAR(solution.energy.absorbed, solution.energy.emitted, 0.005 * solution.energy.emitted);
  EXPECT_EQ(solution.energy.escaped, 0);
}

/// A duct along z from a lamp at z = 0 to a black end at z = length: the part of the lamp's light that arrives.
/// @param side of x = 0 and x = 1, mirrors as well.
double transmission(double length, double wall, double side, int cells, int polar, int azimuth) {
  const int along = static_cast<int>(length) * cells;
  std::vector<Polygon> elements;
  std::vector<double> specular;
  const auto faces = room({1, 1, length});  // floor, ceiling, x = 0, x = 1, y = 0, y = 1
  for (std::size_t f = 0; f < 6; ++f) {
    // Corners of the walls run along the floor or along z first.
    const bool upright = f >= 2 && std::abs(faces[f][1].z - faces[f][0].z) > 0.5 * length;
    const int first = f < 2 ? cells : upright ? along : cells, second = f < 2 ? cells : upright ? cells : along;
    for (Polygon& cell : grid(faces[f], first, second)) {
      elements.push_back(std::move(cell));
      specular.push_back(f < 2 ? 0 : f < 4 ? side : wall);
    }
  }
  const PatchMesh mesh = element_mesh(elements);
  DirectionalProblem problem = grey(mesh.surface_count(), 0, 0, 0);
  problem.specular = specular;
  const auto end = static_cast<std::size_t>(cells * cells);
  std::fill_n(problem.emission.begin(), end, 1.0);
  DirectionalOptions options;
  options.polar_bins = polar;
  options.azimuth_bins = azimuth;
  options.tolerance = 1e-5;
  const auto solution = solve_directional(mesh, problem, options);
  double arrived = 0;
  for (std::size_t i = end; i < 2 * end; ++i) arrived += mesh.areas[i] * solution.irradiance[i];
  return arrived;
}

struct BinCount {
  int cells, polar, azimuth;
};

/// How far the transmission of each duct of the table is from the sum over its images, at each bin count.
void expect_ducts(const std::vector<BinCount>& counts, double at_the_finest) {
  const auto& table = enclosure_table()["mirror_ducts"];
  for (const bool slot : {false, true}) {
    for (const auto& c : table[slot ? "slot" : "square"]) {
      const double l = c["L"], s = c["s"], tau = c["tau"];
      double last = 1;
      for (const auto& [cells, polar, azimuth] : counts) {
        // Lossless mirrors at the sides make the duct an infinite slot.
        const double error = std::abs(transmission(l, s, slot ? 1 : s, cells, polar, azimuth) / tau - 1);
        // Below 0.1 % the rays' noise is seen.
        EXPECT_LT(error, std::max(last, 0.001)) << c << " at " << polar << " x " << azimuth;
        last = error;
      }
      EXPECT_LT(last, at_the_finest) << c;
    }
  }
}

TEST(DirectionalRadiosity, MirrorDucts) { expect_ducts({{2, 4, 8}, {4, 8, 16}}, 0.05); }

TEST(DirectionalRadiosity, SlowMirrorDuctsAt512Bins) { expect_ducts({{4, 8, 16}, {6, 16, 32}}, 0.015); }

/// 1/2, 1/4 or 1/8 of a unit sphere above z = 0 (and beyond x = 0, y = 0), closed by k mirrors; n cells a right angle.
struct MirrorOctant {
  std::vector<Polygon> elements;
  std::size_t curved = 0;

  MirrorOctant(int k, int n) {
    const double azimuth = k == 1 ? 2 * pi : k == 2 ? pi : pi / 2;
    const int around = k == 1 ? 4 * n : k == 2 ? 2 * n : n;
    const auto at = [&](double polar, double turn, double r) {
      return r * Vec3d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
    };
    const auto add = [&](Polygon p) {
      Polygon clean;
      for (const Vec3d& v : p) {
        if (clean.empty() || (length(v - clean.back()) > 1e-9 && length(v - clean.front()) > 1e-9)) clean.push_back(v);
      }
      elements.push_back(clean);
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < around; ++j) {
        const double a = pi / 2 * i / n, b = pi / 2 * (i + 1) / n;
        const double c = azimuth * j / around, d = azimuth * (j + 1) / around;
        add({at(a, c, 1), at(a, d, 1), at(b, d, 1), at(b, c, 1)});
      }
    }
    curved = elements.size();
    // The floor, then the walls along the first and the last meridian.
    for (int i = 0; i < n; ++i) {
      const double r = static_cast<double>(i) / n, s = static_cast<double>(i + 1) / n;
      for (int j = 0; j < around; ++j) {
        const double c = azimuth * j / around, d = azimuth * (j + 1) / around;
        add({at(pi / 2, c, r), at(pi / 2, c, s), at(pi / 2, d, s), at(pi / 2, d, r)});
      }
      for (int wall = 0; wall < k - 1; ++wall) {
        // k = 2: the plane y = 0, both halves; k = 3: the planes y = 0 and x = 0, a quarter each.
        for (const double turn : k == 2 ? std::vector<double>{0, pi} : std::vector<double>{wall * pi / 2}) {
          for (int j = 0; j < n; ++j) {
            const double a = pi / 2 * j / n, b = pi / 2 * (j + 1) / n;
            Polygon p{at(a, turn, r), at(a, turn, s), at(b, turn, s), at(b, turn, r)};
            const bool first = turn == 0;
            add(first ? p : reversed(p));
          }
        }
      }
    }
  }
};

/// The root mean square of (H - beta) / beta over the curved part, whose emission varies as 2 z about its mean of 1.
double octant_error(const nlohmann::json& c, int n, int polar, int azimuth) {
  const MirrorOctant octant(c["k"], n);
  const PatchMesh mesh = element_mesh(octant.elements);
  DirectionalProblem problem = grey(mesh.surface_count(), 0, c["s"], 0);
  double area = 0, emitted = 0;
  for (std::size_t i = 0; i < octant.curved; ++i) {
    problem.specular[i] = 0;
    problem.diffuse[i] = c["mean_rho"];
    problem.emission[i] = 2 * mesh.centroids[i].z;
    area += mesh.areas[i];
    emitted += mesh.areas[i] * problem.emission[i];
  }
  for (std::size_t i = 0; i < octant.curved; ++i) problem.emission[i] *= area / emitted;
  DirectionalOptions options;
  options.polar_bins = polar;
  options.azimuth_bins = azimuth;
  const auto solution = solve_directional(mesh, problem, options);
  double sum = 0;
  const double beta = c["beta"];
  for (std::size_t i = 0; i < octant.curved; ++i) {
    sum += mesh.areas[i] * std::pow(solution.irradiance[i] / beta - 1, 2);
  }
  return std::sqrt(sum / area);
}

// The mirrors rebuild the sphere: the irradiance is the same all over, whatever the pattern.
TEST(DirectionalRadiosity, MirrorOctants) {
  for (const auto& c : enclosure_table()["mirror_octant_two_pass"]["cases"]) {
    EXPECT_LT(octant_error(c, 2 * c["k"].get<int>() + 2, 4, 8), 0.05) << c;
  }
}

TEST(DirectionalRadiosity, SlowMirrorOctantsConvergeWithTheirBins) {
  for (const auto& c : enclosure_table()["mirror_octant_two_pass"]["cases"]) {
    const int k = c["k"];
    const double coarse = octant_error(c, k + 2, 4, 8), fine = octant_error(c, 2 * k + 4, 8, 16);
    EXPECT_LT(fine, 0.03) << c;
    EXPECT_LT(fine, 0.75 * coarse) << c;
  }
}

TEST(DirectionalRadiosity, EnergyOfAnOpenSceneIsAccountedFor) {
  // A glossy floor under a lamp, open to all sides.
  std::vector<Polygon> elements = grid(floor_rectangle(0, 1, 0, 1), 4, 4);
  elements.push_back(reversed(floor_rectangle(0.25, 0.75, 0.25, 0.75, 0.5)));
  const PatchMesh mesh = element_mesh(elements);
  DirectionalProblem problem = grey(mesh.surface_count(), 0.2, 0.5, 0);
  problem.exponent.assign(mesh.surface_count(), 30);
  problem.emission.back() = 1;
  const auto solution = solve_directional(mesh, problem);
  const EnergyBalance& e = solution.energy;
  EXPECT_GT(e.escaped, 0.1 * e.emitted);
  EXPECT_NEAR(e.emitted, e.absorbed + e.escaped, 0.01 * e.emitted);
}

TEST(DirectionalRadiosityThreaded, GivesTheSameBitsOnAnyThreadCount) {
  const PatchMesh mesh = element_mesh(test::room_elements({1, 2, 1}, 2));
  DirectionalProblem problem = grey(mesh.surface_count(), 0.3, 0.4, 1);
  problem.emission[3] = 5;
  problem.exponent.assign(mesh.surface_count(), 5);
  DirectionalOptions options;
  options.max_iterations = 5;
  std::vector<double> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const auto solution = solve_directional(mesh, problem, options);
    if (first.empty()) first = solution.radiance;
    EXPECT_EQ(solution.radiance, first) << threads;
  }
}

TEST(DirectionalRadiosity, RefusesWhatMakesNoSense) {
  const PatchMesh mesh = element_mesh(room({1, 1, 1}));
  EXPECT_THROW((void)solve_directional(mesh, grey(5, 0.5, 0, 1)), std::invalid_argument);
  EXPECT_THROW((void)solve_directional(mesh, grey(6, 0.6, 0.6, 1)), std::invalid_argument);
  DirectionalOptions odd;
  odd.azimuth_bins = 7;
  EXPECT_THROW((void)solve_directional(mesh, grey(6, 0.5, 0, 1), odd), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
