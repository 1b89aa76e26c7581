#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/patch_mesh_builder.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "radiosity/polygon_makers.h"

namespace penumbra::test {

/// A mesh in which each polygon is one element.
inline PatchMesh element_mesh(const std::vector<Polygon>& polygons, std::size_t bands = 1) {
  PatchMeshBuilder builder(bands, {}, [](std::uint32_t face) { return "face " + std::to_string(face); });
  const std::uint32_t paint =
      builder.add_paint({std::vector<double>(bands), std::vector<double>(bands), std::vector<double>(bands)});
  for (std::uint32_t i = 0; i < polygons.size(); ++i) {
    PatchSurface surface;
    surface.name = std::to_string(i);
    surface.face = i;
    builder.add_face(polygons[i], i, builder.add_surface(surface), paint);
  }
  return builder.finish().mesh;
}

/// An n x m grid over a parallelogram, row by row.
inline std::vector<Polygon> grid(const Polygon& q, int n, int m) {
  std::vector<Polygon> cells;
  const auto at = [&](int i, int j) {
    return q[0] + (q[1] - q[0]) * (static_cast<double>(i) / n) + (q[3] - q[0]) * (static_cast<double>(j) / m);
  };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) cells.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  return cells;
}

/// The six faces of a box in n x n cells each, face by face as `room` gives them.
inline std::vector<Polygon> room_elements(const Vec3d& size, int n) {
  std::vector<Polygon> cells;
  for (const Polygon& face : room(size))
    for (Polygon& cell : grid(face, n, n)) cells.push_back(std::move(cell));
  return cells;
}

/// The rows of a full matrix, zeros left out.
inline FactorMatrix sparse(const std::vector<double>& areas, const std::vector<std::vector<double>>& rows) {
  FactorMatrix m;
  m.areas = areas;
  for (const auto& row : rows) {
    for (std::uint32_t j = 0; j < row.size(); ++j) {
      if (row[j] == 0) continue;
      m.columns.push_back(j);
      m.values.push_back(row[j]);
    }
    m.offsets.push_back(m.columns.size());
  }
  m.row_errors.assign(areas.size(), 0.0);
  m.row_dropped.assign(areas.size(), 0.0);
  return m;
}

/// The exact factors of a convex cavity, where nothing hides anything.
inline FactorMatrix convex_factors(const PatchMesh& mesh) {
  const std::size_t n = mesh.patch_count();
  std::vector<std::vector<double>> rows(n, std::vector<double>(n, 0.0));
  parallel_for(n, 8, [&](std::size_t first, std::size_t last) {
    ExchangeAreaScratch scratch;
    for (std::size_t i = first; i < last; ++i)
      for (std::size_t j = i + 1; j < n; ++j) rows[i][j] = exchange_area(mesh.polygon(i), mesh.polygon(j), scratch);
  });
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      rows[j][i] = rows[i][j] / mesh.areas[j];
      rows[i][j] /= mesh.areas[i];
    }
  }
  return sparse(mesh.areas, rows);
}

/// A problem of one reflectance and one emission for all.
inline RadiosityProblem uniform_problem(const std::vector<double>& areas, std::size_t bands, double reflectance,
                                        double emission) {
  RadiosityProblem problem;
  problem.bands = bands;
  problem.areas = areas;
  problem.reflectance.assign(areas.size() * bands, reflectance);
  problem.emission.assign(areas.size() * bands, emission);
  return problem;
}

/// Random reflectances from 0.1 to 0.9, some emitters, light from elsewhere.
inline RadiosityProblem random_problem(const std::vector<double>& areas, std::size_t bands, unsigned seed) {
  Dice dice(seed);
  RadiosityProblem problem = uniform_problem(areas, bands, 0, 0);
  for (double& r : problem.reflectance) r = dice.between(0.1, 0.9);
  for (double& e : problem.emission) e = dice.between(0, 1) < 0.3 ? dice.between(0, 5) : 0;
  for (std::size_t k = 0; k < problem.emission.size(); ++k) problem.irradiance.push_back(dice.between(0, 1));
  return problem;
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

}  // namespace penumbra::test
