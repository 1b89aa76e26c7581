#include "penumbra/radiosity/form_factors/adaptive.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/bsp_sight.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "radiosity/view3d_cases.h"
#include "test_paths.h"

namespace penumbra {
namespace {

using test::read_case;
using test::reference_matrix;

nlohmann::json reference() {
  std::ifstream in(PENUMBRA_TEST_DATA "/radiosity/view_factors_obstructed.json");
  return nlohmann::json::parse(in);
}

FactorMatrix matrix_of(const PatchMesh& mesh, double tolerance,
                       AdaptiveVisibility visibility = AdaptiveVisibility::clipping) {
  AdaptiveOptions options;
  options.tolerance = tolerance;
  options.visibility = visibility;
  return assemble_factor_matrix(*make_adaptive(mesh, options), mesh);
}

double number(const nlohmann::json& value) {
  return value.is_string() ? std::stod(value.get<std::string>()) : value.get<double>();
}

void add_polygon(PolygonModel& model, std::initializer_list<Vec3d> corners, PolygonRole role = PolygonRole::radiates) {
  ModelPolygon polygon;
  polygon.role = role;
  for (const Vec3d& v : corners) {
    polygon.corners.push_back(static_cast<std::uint32_t>(model.vertices.size()));
    model.vertices.push_back(v);
  }
  model.polygons.push_back(polygon);
}

// Two parallel rectangles with a parallel blocker, as the semi-analytic cases describe them.
PatchMesh blocked_pair(const nlohmann::json& c) {
  const auto at = [&](const char* key, int k) { return number(c[key][static_cast<std::size_t>(k)]); };
  const double gap = number(c["gap"]), h = gap * number(c["blocker_fraction_of_gap_from_R1"]);
  PolygonModel model;
  add_polygon(model, {{at("R1x", 0), at("R1y", 0), 0},
                      {at("R1x", 1), at("R1y", 0), 0},
                      {at("R1x", 1), at("R1y", 1), 0},
                      {at("R1x", 0), at("R1y", 1), 0}});
  add_polygon(model, {{at("R2x", 0), at("R2y", 0), gap},
                      {at("R2x", 0), at("R2y", 1), gap},
                      {at("R2x", 1), at("R2y", 1), gap},
                      {at("R2x", 1), at("R2y", 0), gap}});
  add_polygon(model,
              {{at("blocker_x", 0), at("blocker_y", 0), h},
               {at("blocker_x", 1), at("blocker_y", 0), h},
               {at("blocker_x", 1), at("blocker_y", 1), h},
               {at("blocker_x", 0), at("blocker_y", 1), h}},
              PolygonRole::obstructs);
  return make_patch_mesh(model).mesh;
}

TEST(Adaptive, SemiAnalyticBlockers) {
  const nlohmann::json exact_semianalytic =
      reference()["exact_semianalytic"];  // kept: a loop over a temporary would outlive it
  for (const auto& c : exact_semianalytic) {
    const PatchMesh mesh = blocked_pair(c);
    const FactorMatrix m = matrix_of(mesh, 1e-6);
    EXPECT_NEAR(m.at(0, 1), number(c["F_obstructed"]), 2e-6) << c["name"];
  }
}

TEST(Adaptive, HalvingByBspOrderAgreesWithTheSemiAnalyticBlockers) {
  const nlohmann::json exact_semianalytic =
      reference()["exact_semianalytic"];  // kept: a loop over a temporary would outlive it
  for (const auto& c : exact_semianalytic) {
    const PatchMesh mesh = blocked_pair(c);
    const FactorMatrix m = matrix_of(mesh, 1e-5, AdaptiveVisibility::bsp_tree);
    EXPECT_NEAR(m.at(0, 1), number(c["F_obstructed"]), 1e-5) << c["name"];
    EXPECT_NEAR(m.at(0, 1), number(c["F_obstructed"]), m.row_errors[0] + 1e-9) << c["name"];
  }
}

TEST(Adaptive, FacetCube) {
  const PatchMesh mesh = read_case("facet.vs3");
  const FactorMatrix m = matrix_of(mesh, 1e-6);
  const nlohmann::json facet = reference()["facet"];  // kept: a loop over a temporary would outlive it
  for (const auto& entry : facet) {
    const std::size_t i = entry["i"].get<std::size_t>() - 1, j = entry["j"].get<std::size_t>() - 1;
    EXPECT_NEAR(m.at(i, j), entry["F"].get<double>(), 2e-6) << i << " " << j;
  }
  for (std::size_t i = 0; i < m.rows(); ++i) EXPECT_NEAR(m.row_sum(i), 1, 1e-6);
}

TEST(Adaptive, LRoom) {
  const PatchMesh mesh = read_case("l_room.vs3");
  const FactorMatrix m = matrix_of(mesh, 1e-6);
  const auto truth = reference()["l_room"];
  ASSERT_EQ(m.rows(), truth.size());
  for (std::size_t i = 0; i < m.rows(); ++i) {
    EXPECT_NEAR(m.row_sum(i), 1, 1e-6);
    for (std::size_t j = 0; j < m.rows(); ++j) EXPECT_NEAR(m.at(i, j), truth[i][j].get<double>(), 2e-6);
  }
}

TEST(Adaptive, BoxWithoutObstacles) {
  const PatchMesh mesh = read_case("box345_none.vs3");
  const auto truth = reference_matrix("box345_none_F.csv", mesh.surface_count());
  const FactorMatrix m = matrix_of(mesh, 1e-6);
  for (std::size_t i = 0; i < m.rows(); ++i) {
    for (std::size_t j = 0; j < m.rows(); ++j) ASSERT_NEAR(m.at(i, j), truth[i][j], 1e-8) << i << " " << j;
  }
}

TEST(Adaptive, BoxWithTwoCubes) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const auto truth = reference_matrix("box345_AB1.0_F.csv", mesh.surface_count());
  const FactorMatrix m = matrix_of(mesh, 1e-6);
  double worst = 0;
  for (std::size_t i = 0; i < m.rows(); ++i) {
    for (std::size_t j = 0; j < m.rows(); ++j) worst = std::max(worst, std::abs(m.at(i, j) - truth[i][j]));
  }
  RecordProperty("worst", fmt::format("{:.3g}", worst));
  EXPECT_LT(worst, 2e-6);
}

// Walton's way shares no visibility code with the default, and its estimates hold.
TEST(Adaptive, HalvingByBspOrderInTheBoxSlow) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const auto truth = reference_matrix("box345_AB1.0_F.csv", mesh.surface_count());
  const FactorMatrix m = matrix_of(mesh, 1e-3, AdaptiveVisibility::bsp_tree);
  for (std::size_t i = 0; i < m.rows(); ++i) {
    double error = 0;
    for (std::size_t j = 0; j < m.rows(); ++j) error += std::abs(m.at(i, j) - truth[i][j]);
    EXPECT_LT(error, 1e-3);
    EXPECT_LT(error, m.row_errors[i] + 1e-6);
  }
}

TEST(Adaptive, ErrorsKeepTheToleranceOfTheirRow) {
  const PatchMesh mesh = read_case("facet.vs3");
  const FactorMatrix exact = matrix_of(mesh, 1e-7);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const FactorMatrix m = matrix_of(mesh, tolerance);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      double error = 0;
      for (std::size_t j = 0; j < m.rows(); ++j) error += std::abs(m.at(i, j) - exact.at(i, j));
      EXPECT_LE(error, tolerance);
      EXPECT_LE(m.row_errors[i], tolerance);
    }
  }
}

// From one point: the two ways to cut shadows agree with ray counts and with each other's complement.
TEST(BspSight, PiecesOfAClosedRoomFillTheHemisphere) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const BspTree tree(mesh);
  BspSight sight(tree);
  for (std::uint32_t p = 0; p < mesh.radiating_count; p += 13) {
    std::vector<char> blocks(mesh.patch_count(), 1);
    blocks[p] = 0;
    double sum = 0;
    for (std::uint32_t q = 0; q < mesh.radiating_count; ++q) {
      if (q != p) sum += sight.factor(mesh.centroids[p], mesh.normals[p], q, blocks);
    }
    EXPECT_NEAR(sum, 1, 1e-9) << p;
  }
}

TEST(Adaptive, ThreadedRunsGiveTheSameBits) {
  const PatchMesh mesh = read_case("l_room.vs3");
  std::vector<double> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const auto m = matrix_of(mesh, 1e-3);
    if (first.empty()) first = m.values;
    EXPECT_EQ(first, m.values);
  }
}

TEST(Adaptive, RefusesAToleranceThatIsNotPositive) {
  const PatchMesh mesh = read_case("facet.vs3");
  for (const double tolerance : {0.0, -1.0, std::nan("")})
    EXPECT_THROW((void)matrix_of(mesh, tolerance), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
