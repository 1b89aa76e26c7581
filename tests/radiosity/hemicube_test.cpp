#include "penumbra/radiosity/form_factors/hemicube.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "penumbra/io/vs3_reader.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/bsp_tree.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "test_paths.h"

namespace penumbra {
namespace {

// Sums and aliasing errors evaluated independently with Python from the formulas of Cohen & Greenberg 1985.
nlohmann::json reference() {
  std::ifstream in(PENUMBRA_TEST_DATA "/radiosity/hemicube.json");
  return nlohmann::json::parse(in);
}

void add_rectangle(PolygonModel& model, const Vec3d& origin, const Vec3d& u, const Vec3d& v) {
  const auto first = static_cast<std::uint32_t>(model.vertices.size());
  for (const Vec3d& p : {origin, origin + u, origin + u + v, origin + v}) model.vertices.push_back(p);
  ModelPolygon polygon;
  polygon.corners = {first, first + 1, first + 2, first + 3};
  polygon.name = "rectangle";
  model.polygons.push_back(polygon);
}

// Six rectangles that look inwards.
PatchMesh box(const Vec3d& size) {
  PolygonModel model;
  const Vec3d x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z), o(0);
  add_rectangle(model, o, x, y);
  add_rectangle(model, z, y, x);
  add_rectangle(model, o, z, x);
  add_rectangle(model, y, x, z);
  add_rectangle(model, o, y, z);
  add_rectangle(model, x, z, y);
  return make_patch_mesh(model).mesh;
}

PatchMesh read(const char* name) {
  return make_patch_mesh(read_vs3(std::string(PENUMBRA_TEST_DATA "/view3d/") + name).model).mesh;
}

double total(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

TEST(Hemicube, DeltaFactorsSumAsPublished) {
  const nlohmann::json sums = reference()["sums"];  // kept: a loop over a temporary would outlive it
  for (const auto& row : sums) {
    const HemicubeDeltas deltas(row["N"].get<int>());
    EXPECT_NEAR(total(deltas.top), row["top"].get<double>(), 1e-9);
    EXPECT_NEAR(4 * total(deltas.side), row["sides"].get<double>(), 1e-9);
  }
}

TEST(Hemicube, ReproducesTheAliasingOfPixelCentres) {
  const nlohmann::json aliasing = reference()["aliasing"];  // kept: a loop over a temporary would outlive it
  for (const auto& row : aliasing) {
    const double h = row["height"], side = row["side"], x0 = row["offset_x"];
    PolygonModel model;
    add_rectangle(model, {x0 - side / 2, -side / 2, h}, {0, side, 0}, {side, 0, 0});  // looks down
    const PatchMesh mesh = make_patch_mesh(model).mesh;
    const auto factors = hemicube_factors(mesh, Vec3d(0), Frame(), row["N"]);
    EXPECT_NEAR(factors[0], row["F_hemicube_pixel_centres"].get<double>(), 1e-9) << row;
  }
}

// Every pixel of a hemicube in a closed room sees a wall, however it is turned: no gaps, no pixel counted twice.
TEST(Hemicube, ClosedRoomCoversEveryPixelOnce) {
  const PatchMesh mesh = read("box345_AB1.0.vs3");
  const HemicubeDeltas deltas(64);
  const double all = total(deltas.top) + 4 * total(deltas.side);
  for (std::uint64_t k = 0; k < 40; ++k) {
    CounterRng rng(k);
    const Vec3d eye(0.05 + 0.3 * rng.next(), 0.1 + 3.8 * rng.next(), 0.1 + 2.8 * rng.next());
    const double u = rng.next();
    const Frame frame(sample_sphere({u, rng.next()}));
    const auto factors = hemicube_factors(mesh, eye, frame, 64);
    EXPECT_NEAR(total(factors), all, 1e-12);
  }
}

TEST(Hemicube, BspOrderAndRaysSeeWhatTheDepthBufferSees) {
  const PatchMesh mesh = read("box345_AB1.0.vs3");
  const BspTree tree(mesh);
  const PatchTracer tracer(mesh);
  const auto deltas = std::make_shared<HemicubeDeltas>(32);
  int different_pixels = 0;
  for (std::uint32_t p = 0; p < mesh.radiating_count; p += 5) {
    const Vec3d eye = mesh.centroids[p];
    const Frame frame(mesh.normals[p]);
    Hemicube by_depth(deltas), by_order(deltas), by_rays(deltas);
    for (Hemicube* h : {&by_depth, &by_order, &by_rays}) h->place(eye, frame);
    for (std::uint32_t q = 0; q < mesh.patch_count(); ++q) by_depth.draw(mesh.polygon(q), q);
    tree.front_to_back(eye, [&](const BspTree::Fragment& f) { by_order.draw_behind(f.polygon, f.patch); });
    by_rays.cast(tracer, p);
    const auto a = by_depth.sights(mesh.patch_count()), b = by_order.sights(mesh.patch_count());
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].patch, b[k].patch);
      different_pixels += static_cast<int>(std::max(a[k].pixels, b[k].pixels) - std::min(a[k].pixels, b[k].pixels));
    }
    std::vector<double> seen(mesh.patch_count(), 0.0);
    for (const auto& s : by_rays.sights(mesh.patch_count())) seen[s.patch] += s.factor;
    for (const auto& s : a) seen[s.patch] -= s.factor;
    for (const double difference : seen) EXPECT_LT(std::abs(difference), 0.02);  // a row of rim pixels
  }
  EXPECT_LE(different_pixels, 40);  // fragments' new corners are rounded
}

TEST(BspTree, ShowsEachPatchWholeAndInAnOrderInWhichNothingHidesAnEarlierOne) {
  const PatchMesh mesh = read("box345_AB1.0.vs3");
  const BspTree tree(mesh);
  std::vector<double> area(mesh.patch_count(), 0.0);
  const Vec3d eye(0.3, 0.4, 0.2);
  std::vector<std::vector<Vec3d>> shown;
  tree.front_to_back(eye, [&](const BspTree::Fragment& f) {
    area[f.patch] += polygon_area(f.polygon);
    shown.emplace_back(f.polygon.begin(), f.polygon.end());
  });
  for (std::size_t p = 0; p < mesh.patch_count(); ++p) EXPECT_NEAR(area[p], mesh.areas[p], 1e-9);
  // A point strictly inside a later fragment never lies before an earlier one on its line of sight.
  for (std::size_t late = 0; late < shown.size(); ++late) {
    const Vec3d target = polygon_centroid(shown[late]);
    for (std::size_t early = 0; early < late; ++early) {
      const Plane3 plane = polygon_plane(shown[early]);
      const double towards = dot(plane.normal, target - eye);
      if (std::abs(towards) < 1e-9) continue;
      const double t = -plane.distance(eye) / towards;
      if (t > 1 + 1e-6 && convex_contains(shown[early], eye + t * (target - eye))) {
        ADD_FAILURE() << "fragment " << late << " hides " << early;
      }
    }
  }
}

// The notes' sheet of paper: 1 mm above a table, seen from the table's centre, it fills the whole sky.
TEST(Hemicube, PaperOnATableNeedsTheExactNearFactor) {
  PolygonModel model;
  add_rectangle(model, {-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0});          // the table looks up
  add_rectangle(model, {-0.15, -0.1, 1e-3}, {0, 0.2, 0}, {0.3, 0, 0});  // the paper's underside
  add_rectangle(model, {-0.15, -0.1, 1e-3}, {0.3, 0, 0}, {0, 0.2, 0});  // its upper side
  const PatchMesh mesh = make_patch_mesh(model).mesh;
  const double exact = polygon_to_polygon(mesh.polygon(0), mesh.polygon(1));
  EXPECT_NEAR(exact, 0.06, 1e-3);

  const auto table_to_paper = [&](double exact_within) {
    HemicubeOptions options;
    options.exact_within = exact_within;
    return assemble_factor_matrix(*make_hemicube(mesh, options), mesh).at(0, 1);
  };
  // By itself the table's hemicube gives 1; averaged with the paper's own, which is right, half of that remains.
  EXPECT_GT(hemicube_factors(mesh, mesh.centroids[0], Frame(mesh.normals[0]), 128)[1], 0.99);
  EXPECT_GT(std::abs(table_to_paper(0) - exact), 0.4);
  EXPECT_LT(std::abs(table_to_paper(5) - exact), 1e-3);
}

TEST(Hemicube, UnitCubeIsExactWhereAllPairsAreNear) {
  const PatchMesh mesh = box({1, 1, 1});
  for (const auto visibility : {HemicubeVisibility::z_buffer, HemicubeVisibility::bsp_tree, HemicubeVisibility::rays}) {
    HemicubeOptions options;
    options.visibility = visibility;
    options.resolution = 64;
    const FactorMatrix m = assemble_factor_matrix(*make_hemicube(mesh, options), mesh);
    // Rays through the room's edges may take either wall.
    const double tolerance = visibility == HemicubeVisibility::rays ? 0.02 : 1e-9;
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(m.at(i, i), 0);
      EXPECT_NEAR(m.row_sum(i), 1, 5 * tolerance);
      EXPECT_NEAR(m.at(i, i ^ 1U), 0.199824895698387, tolerance);
    }
  }
}

// Without the remedy one point stands for a wall; smaller walls make that right, to second order.
TEST(Hemicube, PlainErrorFallsWithTheSizeOfPatches) {
  const auto opposite_error = [](int n) {
    PolygonModel model;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double s = 1.0 / n;
        add_rectangle(model, {i * s, j * s, 0}, {s, 0, 0}, {0, s, 0});
      }
    }
    add_rectangle(model, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
    const PatchMesh mesh = make_patch_mesh(model).mesh;
    double sum = 0;
    for (int k = 0; k < n * n; ++k) {
      const auto p = static_cast<std::size_t>(k);
      sum += mesh.areas[p] * hemicube_factors(mesh, mesh.centroids[p], Frame(mesh.normals[p]), 256).back();
    }
    return std::abs(sum - 0.199824895698387);
  };
  const double coarse = opposite_error(1), middle = opposite_error(2), fine = opposite_error(4);
  EXPECT_GT(coarse, 0.03);
  EXPECT_LT(middle, coarse / 3);
  EXPECT_LT(fine, middle / 3);
}

// Where nothing stands in between; shadow edges that a centre does not see are not in the estimate.
TEST(Hemicube, EstimatedErrorsCoverTheTrueOnes) {
  const PatchMesh mesh = box({1, 2, 3});
  for (const double exact_within : {0.0, 0.5, 5.0}) {
    HemicubeOptions options;
    options.exact_within = exact_within;
    const FactorMatrix m = assemble_factor_matrix(*make_hemicube(mesh, options), mesh);
    for (std::size_t i = 0; i < m.rows(); ++i) {
      double error = 0;
      for (std::size_t j = 0; j < m.rows(); ++j) {
        if (i != j) error += std::abs(m.at(i, j) - polygon_to_polygon(mesh.polygon(i), mesh.polygon(j)));
      }
      EXPECT_LE(error, m.row_errors[i] + 1e-9) << exact_within;
    }
  }
}

TEST(Hemicube, TurningItChangesThePixelsNotTheFactor) {
  const PatchMesh mesh = read("box345_AB1.0.vs3");
  HemicubeOptions options;
  options.exact_within = 0;
  const FactorMatrix straight = assemble_factor_matrix(*make_hemicube(mesh, options), mesh);
  options.rotate = true;
  const FactorMatrix turned = assemble_factor_matrix(*make_hemicube(mesh, options), mesh);
  double largest = 0;
  for (std::size_t i = 0; i < straight.rows(); ++i) {
    for (std::size_t j = 0; j < straight.rows(); ++j) {
      largest = std::max(largest, std::abs(straight.at(i, j) - turned.at(i, j)));
    }
  }
  EXPECT_GT(largest, 0);
  EXPECT_LT(largest, 0.01);
}

TEST(Hemicube, ThreadedRunsGiveTheSameBits) {
  const PatchMesh mesh = read("box345_AB1.0.vs3");
  HemicubeOptions options;
  options.rotate = true;
  options.resolution = 32;
  std::vector<double> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const auto m = assemble_factor_matrix(*make_hemicube(mesh, options), mesh);
    if (first.empty()) first = m.values;
    EXPECT_EQ(first, m.values);
  }
}

TEST(Hemicube, RefusesOptionsOutOfRange) {
  const PatchMesh mesh = box({1, 1, 1});
  for (const int resolution : {0, 1, 7, -2, 5000}) {
    HemicubeOptions options;
    options.resolution = resolution;
    EXPECT_THROW((void)make_hemicube(mesh, options), std::invalid_argument);
  }
  HemicubeOptions options;
  options.exact_within = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)make_hemicube(mesh, options), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
