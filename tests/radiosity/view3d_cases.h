#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "penumbra/io/vs3_reader.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "test_paths.h"

namespace penumbra::test {

/// A case of tests/data/view3d as patches.
inline PatchMesh read_case(const std::string& name) {
  return make_patch_mesh(read_vs3(PENUMBRA_TEST_DATA "/view3d/" + name).model).mesh;
}

/// F[i][j] of a reference file with lines i,j,A_i,F_ij (from 1, i < j), both halves filled in by reciprocity.
inline std::vector<std::vector<double>> reference_matrix(const std::string& name, std::size_t rows) {
  std::ifstream in(PENUMBRA_TEST_DATA "/view3d/" + name);
  EXPECT_TRUE(in.good()) << name;
  std::vector<std::vector<double>> f(rows, std::vector<double>(rows, 0.0));
  std::vector<double> area(rows, 0.0);
  struct Pair {
    std::size_t i, j;
    double factor;
  };
  std::vector<Pair> pairs;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    char comma = 0;
    Pair pair{};
    double a = 0;
    words >> pair.i >> comma >> pair.j >> comma >> a >> comma >> pair.factor;
    area.at(pair.i - 1) = a;
    pairs.push_back(pair);
  }
  EXPECT_GT(pairs.size(), 100U);
  for (const Pair& p : pairs) f[p.i - 1][p.j - 1] = p.factor;
  // Only A_i of a row with a later partner is given; the last rows have no line of their own.
  for (const Pair& p : pairs) {
    const double other = area[p.j - 1] > 0 ? area[p.j - 1] : 1.0;
    f[p.j - 1][p.i - 1] = p.factor * area[p.i - 1] / other;
  }
  return f;
}

}  // namespace penumbra::test
