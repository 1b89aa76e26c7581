#include "penumbra/radiosity/form_factors/pair_methods.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "radiosity/enclosures.h"
#include "radiosity/view3d_cases.h"

namespace penumbra {
namespace {

using test::read_case;
using test::reference_matrix;

// The sum of a row's true errors is within what the method says of itself, on a room with nothing in it.
TEST(PairMethods, EstimatesCoverTheErrorsInAnEmptyBox) {
  const PatchMesh mesh = read_case("box345_none.vs3");
  const auto truth = reference_matrix("box345_none_F.csv", mesh.surface_count());
  for (const char* name : {"point", "nusselt", "analytic"}) {
    const FactorMatrix m = assemble_factor_matrix(*make_form_factor_method(name, mesh), mesh);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      double error = 0;
      for (std::size_t j = 0; j < m.rows(); ++j) error += std::abs(m.at(i, j) - truth[i][j]);
      EXPECT_LE(error, m.row_errors[i] + 1e-7) << name << " " << i;
      EXPECT_EQ(m.at(i, i), 0);
    }
  }
}

TEST(PairMethods, NusseltIsBetterThanPointAndAnalyticIsExact) {
  const PatchMesh mesh = read_case("box345_none.vs3");
  const auto truth = reference_matrix("box345_none_F.csv", mesh.surface_count());
  const auto worst = [&](const char* name) {
    const FactorMatrix m = assemble_factor_matrix(*make_form_factor_method(name, mesh), mesh);
    double largest = 0;
    for (std::size_t i = 0; i < m.rows(); ++i) {
      for (std::size_t j = 0; j < m.rows(); ++j) largest = std::max(largest, std::abs(m.at(i, j) - truth[i][j]));
    }
    return largest;
  };
  const double point = worst("point"), nusselt = worst("nusselt"), analytic = worst("analytic");
  EXPECT_LT(nusselt, point);
  EXPECT_LT(analytic, 1e-8);
}

// Regular grids: many lines between centres pass exactly through the room's edges.
TEST(PairMethods, NothingShinesThroughTheEdgesOfAClosedRoom) {
  for (const int n : {3, 4, 5}) {
    std::vector<Polygon> polygons = test::room_elements({1, 1, 1}, n);
    const std::size_t inside = polygons.size();
    for (const int m : {4, 7}) {
      polygons.resize(inside);
      const Polygon lamp{{2, -0.5, -0.5}, {2, -0.5, 1.5}, {2, 1.5, 1.5}, {2, 1.5, -0.5}};
      for (Polygon& cell : test::grid(lamp, m, m)) polygons.push_back(std::move(cell));
      const PatchMesh mesh = test::element_mesh(polygons);
      for (const char* name : {"point", "nusselt", "hemicube", "auto"}) {
        const auto method = make_form_factor_method(name, mesh);
        for (std::size_t block = 0; block < method->block_count(); ++block) {
          for (const PairFactor& pair : method->block(block).pairs) {
            EXPECT_FALSE(pair.i < inside && pair.j >= inside && pair.exchange > 0)
                << name << " " << n << " " << m << " " << pair.exchange;
          }
        }
      }
    }
  }
}

// Where something stands partly in between, what the method cannot know is in its error.
TEST(PairMethods, AnalyticOwnsUpToPartlyHiddenPairs) {
  const PatchMesh mesh = read_case("box345_AB1.0.vs3");
  const auto truth = reference_matrix("box345_AB1.0_F.csv", mesh.surface_count());
  const FactorMatrix m = assemble_factor_matrix(*make_analytic(mesh), mesh);
  for (std::size_t i = 0; i < m.rows(); ++i) {
    double error = 0;
    for (std::size_t j = 0; j < m.rows(); ++j) error += std::abs(m.at(i, j) - truth[i][j]);
    EXPECT_LE(error, m.row_errors[i] + 1e-6) << i;
  }
}

TEST(PairMethods, EveryNamedMethodCanBeMade) {
  const PatchMesh mesh = read_case("facet.vs3");
  for (const std::string_view name : form_factor_method_names()) {
    FormFactorOptions options;
    options.tolerance = 1e-2;
    const auto method = make_form_factor_method(name, mesh, options);
    EXPECT_EQ(method->name(), name);
    const FactorMatrix m = assemble_factor_matrix(*method, mesh);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      for (std::size_t j = 0; j < m.rows(); ++j) EXPECT_NEAR(m.areas[i] * m.at(i, j), m.areas[j] * m.at(j, i), 1e-14);
      if (name == "adaptive" || name == "ray-cast" || name == "auto") {
        EXPECT_NEAR(m.row_sum(i), 1, 0.03) << name;
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
