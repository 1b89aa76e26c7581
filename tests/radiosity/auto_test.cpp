#include "penumbra/radiosity/form_factors/auto.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <glm/ext/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "penumbra/math/transform.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/pair_methods.h"
#include "penumbra/scene/builtin_scenes.h"
#include "radiosity/polygon_makers.h"
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

double number(const nlohmann::json& value) {
  return value.is_string() ? std::stod(value.get<std::string>()) : value.get<double>();
}

FactorMatrix matrix_of(const PatchMesh& mesh, double tolerance, bool merge = true) {
  FormFactorOptions options;
  options.tolerance = tolerance;
  AutoFormFactors::Settings settings;
  settings.merge_occluders = merge;
  return assemble_factor_matrix(AutoFormFactors(mesh, options, settings), mesh);
}

void add_rectangle(PolygonModel& model, const Vec3d& corner, const Vec3d& u, const Vec3d& v,
                   PolygonRole role = PolygonRole::radiates) {
  ModelPolygon polygon;
  polygon.role = role;
  for (const Vec3d& p : {corner, corner + u, corner + u + v, corner + v}) {
    polygon.corners.push_back(static_cast<std::uint32_t>(model.vertices.size()));
    model.vertices.push_back(p);
  }
  model.polygons.push_back(polygon);
}

/// The six walls of a cube in n x n squares; `inwards` for a room.
void add_cube(PolygonModel& model, double lower, double upper, int n, bool inwards) {
  const double step = (upper - lower) / n;
  for (int axis = 0; axis < 3; ++axis) {
    for (int end = 0; end < 2; ++end) {
      Vec3d u(0), v(0);
      u[(axis + 1) % 3] = step;
      v[(axis + 2) % 3] = step;
      if ((end == 1) == inwards) std::swap(u, v);
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          Vec3d corner(lower);
          corner[axis] = end == 1 ? upper : lower;
          add_rectangle(model, corner + static_cast<double>(i) * u + static_cast<double>(j) * v, u, v);
        }
      }
    }
  }
}

PatchMesh room_with_box(int n) {
  PolygonModel model;
  add_cube(model, 0, 1, n, true);
  add_cube(model, 0.25, 0.75, n, false);
  return make_patch_mesh(model).mesh;
}

double row_error(const FactorMatrix& m, const std::vector<std::vector<double>>& truth, std::size_t i) {
  double sum = 0;
  for (std::size_t j = 0; j < m.rows(); ++j) sum += std::abs(m.at(i, j) - truth[i][j]);
  return sum;
}

TEST(Auto, SemiAnalyticBlockers) {
  const nlohmann::json exact_semianalytic =
      reference()["exact_semianalytic"];  // kept: a loop over a temporary would outlive it
  for (const auto& c : exact_semianalytic) {
    const auto at = [&](const char* key, int k) { return number(c[key][static_cast<std::size_t>(k)]); };
    const double gap = number(c["gap"]), h = gap * number(c["blocker_fraction_of_gap_from_R1"]);
    const auto side = [&](const char* key) { return at(key, 1) - at(key, 0); };
    PolygonModel model;
    add_rectangle(model, {at("R1x", 0), at("R1y", 0), 0}, {side("R1x"), 0, 0}, {0, side("R1y"), 0});
    add_rectangle(model, {at("R2x", 0), at("R2y", 0), gap}, {0, side("R2y"), 0}, {side("R2x"), 0, 0});
    add_rectangle(model, {at("blocker_x", 0), at("blocker_y", 0), h}, {side("blocker_x"), 0, 0},
                  {0, side("blocker_y"), 0}, PolygonRole::obstructs);
    const FactorMatrix m = matrix_of(make_patch_mesh(model).mesh, 1e-6);
    EXPECT_NEAR(m.at(0, 1), number(c["F_obstructed"]), 2e-6) << c["name"];
  }
}

TEST(Auto, PublishedRoomsWithinTwoMillionths) {
  const auto all = reference();
  const PatchMesh facet = read_case("facet.vs3");
  const FactorMatrix f = matrix_of(facet, 1e-6);
  for (const auto& e : all["facet"]) {
    const auto i = e["i"].get<std::size_t>() - 1, j = e["j"].get<std::size_t>() - 1;
    EXPECT_NEAR(f.at(i, j), number(e["F"]), 2e-6) << i << " " << j;
    EXPECT_NEAR(f.at(j, i) * f.areas[j], number(e["F"]) * f.areas[i], 2e-6);
  }
  const FactorMatrix l = matrix_of(read_case("l_room.vs3"), 1e-6);
  const auto& truth = all["l_room"];
  ASSERT_EQ(l.rows(), 8U);
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t j = 0; j < 8; ++j) EXPECT_NEAR(l.at(i, j), number(truth[i][j]), 2e-6) << i << " " << j;
}

TEST(Auto, EveryEntryOfTheBoxWithTwoCubes) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const auto truth = reference_matrix("box345_AB1.0_F.csv", mesh.surface_count());
  const FactorMatrix m = matrix_of(mesh, 1e-6);
  for (std::size_t i = 0; i < m.rows(); ++i)
    for (std::size_t j = 0; j < m.rows(); ++j) EXPECT_NEAR(m.at(i, j), truth[i][j], 2e-6) << i << " " << j;
}

TEST(Auto, EmptyBoxIsTheClosedForm) {
  const PatchMesh mesh = read_case("box345_none.vs3");
  const FactorMatrix m = matrix_of(mesh, 1e-6);
  const FactorMatrix exact = assemble_factor_matrix(*make_analytic(mesh), mesh);
  for (std::size_t i = 0; i < m.rows(); ++i)
    for (std::size_t j = 0; j < m.rows(); ++j) EXPECT_NEAR(m.at(i, j), exact.at(i, j), 1e-7);
}

// A room with a box, all of its walls in triangles that meet corner to corner; `uneven`: corners inside the walls are
// moved, so that no two triangles lie in one plane. Nothing leaves such a room.
PatchMesh triangle_room(int n, double uneven) {
  PolygonModel model;
  add_cube(model, 0, 1, n, true);
  add_cube(model, 0.25, 0.75, n, false);
  PolygonModel triangles;
  triangles.vertices = model.vertices;
  for (const ModelPolygon& square : model.polygons) {
    for (std::size_t half : {1U, 2U}) {
      ModelPolygon triangle = square;
      triangle.corners = {square.corners[0], square.corners[half], square.corners[half + 1]};
      triangles.polygons.push_back(triangle);
    }
  }
  for (Vec3d& v : triangles.vertices) {
    const double outside = length(v - Vec3d(0.5)),
                 wave = std::sin(9 * v.x + 1) * std::sin(8 * v.y + 2) * std::sin(7 * v.z);
    v += uneven / n * wave / outside * (v - Vec3d(0.5));
  }
  return make_patch_mesh(triangles).mesh;
}

TEST(Auto, TrianglesThatHideEachForItselfHideWhatTheirWallsHide) {
  const PatchMesh mesh = triangle_room(3, 0);
  const FactorMatrix merged = matrix_of(mesh, 1e-4), apart = matrix_of(mesh, 1e-4, false);
  for (std::size_t i = 0; i < mesh.surface_count(); ++i) {
    double difference = 0;
    for (std::size_t j = 0; j < mesh.surface_count(); ++j) difference += std::abs(merged.at(i, j) - apart.at(i, j));
    EXPECT_LE(difference, 2e-4) << i;
    EXPECT_NEAR(apart.row_sum(i), 1, 1e-4) << i;
  }
}

// Also where patches see each other along the horizon only, as neighbours in an uneven wall do.
TEST(Auto, NothingInBetweenAddsLight) {
  const PatchMesh mesh = triangle_room(2, 0.3);
  const FactorMatrix m = matrix_of(mesh, 1e-3);
  for (std::size_t i = 0; i < m.rows(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double open = exchange_area(mesh.polygon(i), mesh.polygon(j)) / mesh.areas[i];
      EXPECT_LE(m.at(i, j), open * 1.001 + 1e-5) << i << " " << j;
    }
  }
}

// Neighbours in such walls touch, and hide parts of each other along the horizon.
TEST(Auto, UnevenRoomsClose) {
  const PatchMesh mesh = triangle_room(2, 0.3);
  for (double tolerance : {1e-3, 1e-4}) {
    const FactorMatrix m = matrix_of(mesh, tolerance);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      EXPECT_NEAR(m.row_sum(i), 1, tolerance) << i;
      EXPECT_LE(m.row_errors[i], tolerance) << i;
      EXPECT_LE(std::abs(m.row_sum(i) - 1), m.row_errors[i] + 2e-6) << i;
    }
  }
}

// Half-shadows of a hundredth of the square's width (semi-analytic: view_factors_obstructed.json).
TEST(Auto, EstimateHoldsForAPlateCloseToTheReceiver) {
  PolygonModel model;
  add_rectangle(model, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_rectangle(model, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  add_rectangle(model, {0.25, 0.25, 0.01}, {0.5, 0, 0}, {0, 0.5, 0});
  const PatchMesh mesh = make_patch_mesh(model).mesh;
  for (double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const FactorMatrix m = matrix_of(mesh, tolerance);
    const double error = std::abs(m.at(0, 1) - 0.1418679263878689);
    EXPECT_LE(error, m.row_errors[0] + 1e-9) << tolerance;
    EXPECT_LE(m.row_errors[0], tolerance);
  }
}

/// Plates at heights of 1e-4 to 0.4 over a unit square, in front of one that faces it.
PolygonModel plates_over_a_square(Dice& dice, int run) {
  PolygonModel model;
  add_rectangle(model, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_rectangle(model, {dice.between(-0.5, 0.3), dice.between(-0.5, 0.3), dice.between(0.5, 1.5)}, {0, 1, 0},
                {1, 0, 0});
  for (int k = 0; k <= run % 3; ++k)
    add_rectangle(model, {dice.between(-0.2, 0.9), dice.between(-0.2, 0.9), std::pow(10, dice.between(-4, -0.4))},
                  {dice.between(0.1, 0.8), 0, 0}, {0, dice.between(0.1, 0.8), 0});
  return model;
}

Vec3d in_a_cube(Dice& dice, double half) {
  return {dice.between(-half, half), dice.between(-half, half), dice.between(-half, half)};
}

/// Plates anywhere, turned anyhow, many of them through each other.
PolygonModel plates_anywhere(Dice& dice, int run) {
  PolygonModel model;
  for (int k = 0; k < 3 + run % 4; ++k) {
    const Vec3d u = normalize(in_a_cube(dice, 1)), v = normalize(cross(u, in_a_cube(dice, 1)));
    const Vec3d corner = in_a_cube(dice, 0.7);
    add_rectangle(model, corner, dice.between(0.1, 1) * u, dice.between(0.1, 1) * v);
  }
  return model;
}

/// Plates above each other by 1e-3 to 1, tilted a little, so that close ones cross.
PolygonModel stacked_plates(Dice& dice, int run) {
  PolygonModel model;
  double height = 0;
  for (int k = 0; k < 3 + run % 3; ++k) {
    const double tilt = std::pow(10, dice.between(-4, -1));
    const Vec3d u = normalize(Vec3d(1, 0, 0) + in_a_cube(dice, tilt));
    const Vec3d v = normalize(cross(Vec3d(0, 0, 1) + in_a_cube(dice, 0.01), u));
    const Vec3d corner(dice.between(-0.5, 0.5), dice.between(-0.5, 0.5), height);
    const Vec3d along = dice.between(0.2, 1) * u, across = dice.between(0.2, 1) * v;
    if (dice.between(0, 1) < 0.5)
      add_rectangle(model, corner, along, across);
    else
      add_rectangle(model, corner, across, along);
    height += std::pow(10, dice.between(-3, 0));
  }
  return model;
}

// Against the same at 1e-7. An estimate is not a bound: a few rows may err by more, none by more than the tolerance.
TEST(Auto, EstimatesHoldForPlatesAtRandom) {
  for (const auto& plates : {plates_over_a_square, plates_anywhere, stacked_plates}) {
    Dice dice(5);
    int rows = 0, held = 0;
    for (int run = 0; run < 15; ++run) {
      const PatchMesh mesh = make_patch_mesh(plates(dice, run)).mesh;
      const FactorMatrix truth = matrix_of(mesh, 1e-7);
      for (double tolerance : {1e-2, 1e-3, 1e-4}) {
        const FactorMatrix m = matrix_of(mesh, tolerance);
        for (std::size_t i = 0; i < m.rows(); ++i) {
          double error = 0;
          for (std::size_t j = 0; j < m.rows(); ++j) error += std::abs(m.at(i, j) - truth.at(i, j));
          EXPECT_LE(error, tolerance + truth.row_errors[i]) << "run " << run << " row " << i;
          EXPECT_LE(error, 6 * (m.row_errors[i] + truth.row_errors[i]) + 1e-8) << "run " << run << " row " << i;
          ++rows;
          if (error <= m.row_errors[i] + truth.row_errors[i] + 1e-8) ++held;
        }
      }
    }
    EXPECT_GE(held, rows * 98 / 100);
  }
}

TEST(Auto, ToleranceBoundsEachRowsError) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const auto truth = reference_matrix("box345_AB1.0_F.csv", mesh.surface_count());
  for (double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const FactorMatrix m = matrix_of(mesh, tolerance);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      EXPECT_LE(row_error(m, truth, i), tolerance) << i;
      EXPECT_LE(m.row_errors[i], tolerance) << i;
    }
  }
}

TEST(Auto, ClosedRoomsCloseAndExchangeIsMutual) {
  for (int n : {3, 4, 6}) {  // 4 puts patch edges on the box's planes, 3 and 6 do not
    const PatchMesh mesh = room_with_box(n);
    const FactorMatrix m = matrix_of(mesh, 1e-4);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      EXPECT_NEAR(m.row_sum(i), 1, 1e-4) << i;
      EXPECT_EQ(m.at(i, i), 0);
      const auto columns = m.row_columns(i);
      const auto values = m.row_values(i);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        EXPECT_GE(values[k], 0);
        const double there = m.areas[i] * values[k], back = m.areas[columns[k]] * m.at(columns[k], i);
        EXPECT_NEAR(there, back, 1e-14 * there);
      }
    }
  }
}

TEST(Auto, MovedTurnedAndScaledRoomsAreTheSame) {
  const PatchMesh mesh = room_with_box(3);
  const FactorMatrix m = matrix_of(mesh, 1e-5);
  const Mat4d turn = glm::rotate(glm::translate(Mat4d(1.0), Vec3d(5, -3, 40)), 1.1, normalize(Vec3d(1, 2, 3)));
  for (double scale : {1e-3, 1.0, 300.0}) {
    PatchMesh other = mesh;
    for (auto* points : {&other.vertices, &other.corner_positions, &other.centroids})
      for (Vec3d& p : *points) p = scale * transform_point(turn, p);
    for (Vec3d& n : other.normals) n = Mat3d(turn) * n;
    for (double& a : other.areas) a *= scale * scale;
    for (PatchSurface& s : other.surfaces) s.area *= scale * scale;
    const FactorMatrix t = matrix_of(other, 1e-5);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      double difference = 0;
      for (std::size_t j = 0; j < m.rows(); ++j) difference += std::abs(m.at(i, j) - t.at(i, j));
      EXPECT_LE(difference, 2e-5) << i << " scale " << scale;
    }
  }
}

TEST(Auto, RenumberingRenumbersTheMatrix) {
  PolygonModel model;
  add_cube(model, 0, 1, 3, true);
  add_cube(model, 0.3, 0.6, 2, false);
  const FactorMatrix m = matrix_of(make_patch_mesh(model).mesh, 1e-5);
  std::vector<std::size_t> order(model.polygons.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937 random(7);
  std::shuffle(order.begin(), order.end(), random);
  PolygonModel shuffled = model;
  for (std::size_t k = 0; k < order.size(); ++k) shuffled.polygons[k] = model.polygons[order[k]];
  const FactorMatrix s = matrix_of(make_patch_mesh(shuffled).mesh, 1e-5);
  for (std::size_t i = 0; i < order.size(); ++i) {
    double difference = 0;
    for (std::size_t j = 0; j < order.size(); ++j) difference += std::abs(s.at(i, j) - m.at(order[i], order[j]));
    EXPECT_LE(difference, 2e-5) << i;
  }
}

TEST(Auto, PlatesHideOnBothSidesAndSeeFromBoth) {
  // A two-sided plate across the middle of a cube: each half is a closed room.
  PolygonModel model;
  add_cube(model, 0, 1, 2, true);
  add_rectangle(model, {0, 0, 0.5}, {1, 0, 0}, {0, 1, 0});
  add_rectangle(model, {0, 0, 0.5}, {0, 1, 0}, {1, 0, 0});
  const PatchMesh mesh = make_patch_mesh(model).mesh;
  const FactorMatrix m = matrix_of(mesh, 1e-6);
  for (std::size_t i = 0; i < m.rows(); ++i) {
    EXPECT_NEAR(m.row_sum(i), 1, 2e-6) << i;
    for (std::size_t j = 0; j < m.rows(); ++j) {
      const bool across = (mesh.centroids[i].z - 0.5) * (mesh.centroids[j].z - 0.5) < 0;
      EXPECT_TRUE(!across || m.at(i, j) == 0);
    }
  }
}

TEST(Auto, UnmergedOccludersGiveTheSameFactors) {
  const PatchMesh mesh = room_with_box(3);
  const FactorMatrix merged = matrix_of(mesh, 1e-5), loose = matrix_of(mesh, 1e-5, false);
  for (std::size_t i = 0; i < merged.rows(); ++i) {
    double difference = 0;
    for (std::size_t j = 0; j < merged.rows(); ++j) difference += std::abs(merged.at(i, j) - loose.at(i, j));
    EXPECT_LE(difference, 2e-5) << i;
  }
}

TEST(Auto, RowsAreThoseOfTheMatrix) {
  const PatchMesh mesh = room_with_box(3);
  FormFactorOptions options;
  options.tolerance = 1e-4;
  const AutoFormFactors factors(mesh, options);
  const FactorMatrix matrix = assemble_factor_matrix(factors, mesh);
  for (std::uint32_t i = 0; i < mesh.surface_count(); i += 7) {
    const PatchRow row = factors.row(i);
    double sum = 0, difference = 0;
    for (std::size_t k = 0; k < row.patches.size(); ++k) {
      sum += row.exchanges[k] / mesh.areas[i];
      difference += std::abs(row.exchanges[k] / mesh.areas[i] - matrix.at(i, row.patches[k]));
    }
    EXPECT_NEAR(sum, 1, 1e-4) << i;
    EXPECT_LT(difference, 2e-4) << i;
  }
}

// Long triangles that share an edge, and cavities of them: where patches touch, no rule but the closed form will do.
TEST(Auto, TouchingTrianglesAreExact) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int run = 0; run < 100; ++run) {
    // A tetrahedron, seen from within: closed, without anything in the way.
    std::array<Vec3d, 4> corner;
    for (Vec3d& c : corner) c = Vec3d(4 * uniform(random), uniform(random), uniform(random));
    if (dot(cross(corner[1] - corner[0], corner[2] - corner[0]), corner[3] - corner[0]) < 0)
      std::swap(corner[1], corner[2]);
    PolygonModel model;
    for (const auto& face : {std::array{0, 1, 2}, std::array{0, 3, 1}, std::array{0, 2, 3}, std::array{1, 3, 2}}) {
      ModelPolygon polygon;
      for (int c : face) {
        polygon.corners.push_back(static_cast<std::uint32_t>(model.vertices.size()));
        model.vertices.push_back(corner[static_cast<std::size_t>(c)]);
      }
      model.polygons.push_back(polygon);
    }
    const FactorMatrix m = matrix_of(make_patch_mesh(model).mesh, 1e-6);
    for (std::size_t i = 0; i < m.rows(); ++i) EXPECT_NEAR(m.row_sum(i), 1, 1e-6) << "run " << run << " row " << i;
  }
}

TEST(Auto, RefusesAToleranceThatIsNotPositive) {
  const PatchMesh mesh = read_case("facet.vs3");
  EXPECT_THROW(matrix_of(mesh, 0), std::invalid_argument);
  EXPECT_THROW(matrix_of(mesh, -1), std::invalid_argument);
  EXPECT_THROW(matrix_of(mesh, std::nan("")), std::invalid_argument);
}

TEST(Auto, CityRowsStayBelowOne) {
  const MadePatchMesh made = make_patch_mesh(make_builtin_scene("city?facets=1000"));
  const FactorMatrix m = matrix_of(made.mesh, 1e-3);
  double most = 0;
  for (std::size_t i = 0; i < m.rows(); ++i) {
    EXPECT_LE(m.row_sum(i), 1 + 1e-3);
    EXPECT_LE(m.row_errors[i], 1e-3);
    most = std::max(most, m.row_sum(i));
  }
  EXPECT_GT(most, 0.3);  // street level sees walls
}

// The thread sanitizer makes it a hundred times slower: a smaller room keeps the blocks many enough to share.
#ifdef __SANITIZE_THREAD__
constexpr int threaded_room = 2;
#else
constexpr int threaded_room = 6;
#endif

TEST(Auto, ThreadedRunsGiveTheSameBits) {
  const PatchMesh mesh = room_with_box(threaded_room);
  FactorMatrix first;
  for (int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    FactorMatrix m = matrix_of(mesh, 1e-4);
    if (threads == 1) {
      first = std::move(m);
      continue;
    }
    EXPECT_EQ(m.columns, first.columns);
    EXPECT_EQ(m.values, first.values);
    EXPECT_EQ(m.row_errors, first.row_errors);
  }
}

}  // namespace
}  // namespace penumbra
