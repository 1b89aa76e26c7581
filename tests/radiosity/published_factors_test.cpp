// The targets that OpenViewFactor publishes for its verification (github.com/OpenViewFactor/verification-scripts), on
// geometry made here: closed forms of 15 digits. Three of its targets for concentric spheres are ratios of radii where
// the factor is the ratio of areas; they are not matched.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/shape_polygons.h"
#include "radiosity/polygon_makers.h"

namespace penumbra {
namespace {

constexpr double tolerance = 1e-6;

void add_surface(PolygonModel& model, const std::vector<Polygon>& polygons, PolygonRole role) {
  const auto head = static_cast<std::uint32_t>(model.polygons.size());
  for (const Polygon& polygon : polygons) {
    ModelPolygon p;
    p.role = role;
    if (role == PolygonRole::radiates && model.polygons.size() > head) p.combines_with = head;
    for (const Vec3d& v : polygon) {
      p.corners.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.push_back(v);
    }
    model.polygons.push_back(p);
  }
}

// F from one mesh to another, each one surface, and back.
std::array<double, 2> factors_between(const std::vector<Polygon>& from, const std::vector<Polygon>& to,
                                      const std::vector<Polygon>& blockers = {}) {
  PolygonModel model;
  add_surface(model, from, PolygonRole::radiates);
  add_surface(model, to, PolygonRole::radiates);
  add_surface(model, blockers, PolygonRole::obstructs);
  const PatchMesh mesh = make_patch_mesh(model).mesh;
  FormFactorOptions options;
  options.tolerance = tolerance;
  options.between_surfaces_only = true;
  const FactorMatrix m = assemble_factor_matrix(*make_form_factor_method("auto", mesh, options), mesh);
  EXPECT_LE(m.row_errors[0], tolerance);
  return {m.at(0, 1), m.at(1, 0)};
}

// Triangles, as an STL file holds them: at least 4 x 4 nearly square cells cut in two.
std::vector<Polygon> triangles(const Polygon& rectangle) {
  const double a = length(rectangle[1] - rectangle[0]), b = length(rectangle[3] - rectangle[0]);
  const double cell = std::min(a, b) / 4;
  const double nu = std::round(a / cell), nv = std::round(b / cell);
  const Vec3d u = (rectangle[1] - rectangle[0]) / nu, v = (rectangle[3] - rectangle[0]) / nv;
  std::vector<Polygon> out;
  for (double j = 0; j < nv; ++j) {
    for (double i = 0; i < nu; ++i) {
      const Vec3d at = rectangle[0] + i * u + j * v;
      out.push_back({at, at + u, at + u + v});
      out.push_back({at, at + u + v, at + v});
    }
  }
  return out;
}

std::vector<Polygon> fan(const Polygon& polygon) {
  std::vector<Polygon> out;
  const Vec3d centre = polygon_centroid(polygon);
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    out.push_back({centre, polygon[k], polygon[(k + 1) % polygon.size()]});
  }
  return out;
}

TEST(PublishedFactors, ParallelPlates) {
  constexpr std::array<std::array<double, 2>, 8> targets{{{0.1, 0.003162056838754},
                                                          {0.2, 0.012403977313243},
                                                          {0.4, 0.046137416744875},
                                                          {0.6, 0.093362337840650},
                                                          {1, 0.199824895698387},
                                                          {2, 0.415253283577147},
                                                          {4, 0.632036430013860},
                                                          {10, 0.826994522397256}}};
  for (const auto& [side, factor] : targets) {
    const Polygon lower = floor_rectangle(0, side, 0, side), upper = reversed(moved(lower, {0, 0, 1}));
    EXPECT_NEAR(factors_between(triangles(lower), triangles(upper))[0], factor, tolerance) << side;
  }
}

TEST(PublishedFactors, NothingPassesAPlateAsLargeAsBoth) {
  const Polygon lower = floor_rectangle(0, 1, 0, 1), upper = reversed(moved(lower, {0, 0, 1}));
  const auto blocker = std::vector<Polygon>{moved(lower, {0, 0, 0.5})};
  EXPECT_EQ(factors_between(triangles(lower), triangles(upper), blocker)[0], 0);
}

// Shared edge of length 1 (offset 0), and plates that begin 0.1 from the line in which their planes meet.
TEST(PublishedFactors, PerpendicularPlates) {
  struct Target {
    double horizontal, vertical, offset, factor;
  };
  constexpr std::array<Target, 16> targets{{{0.1, 0.1, 0, 0.281887806787901},
                                            {0.2, 0.2, 0, 0.271036935697358},
                                            {0.4, 0.4, 0, 0.250319555056282},
                                            {0.6, 0.6, 0, 0.231469999626555},
                                            {1, 1, 0, 0.200043776075403},
                                            {2, 2, 0, 0.149299795886762},
                                            {4, 4, 0, 0.101358700221681},
                                            {10, 10, 0, 0.055023979528411},
                                            {0.1, 0.1, 0.1, 0.099641323889039},
                                            {0.1, 1, 0.1, 0.264776412027033},
                                            {0.5, 0.1, 0.1, 0.046900754681815},
                                            {1, 1, 0.1, 0.154206868494109},
                                            {2, 2, 0.1, 0.123295563178043},
                                            {4, 4, 0.1, 0.087423913145759},
                                            {10, 10, 0.1, 0.049213054565814},
                                            {10, 1, 0.1, 0.020339424193314}}};
  for (const Target& t : targets) {
    const double y0 = t.offset, y1 = t.offset + t.horizontal, z0 = t.offset, z1 = t.offset + t.vertical;
    const Polygon floor = floor_rectangle(y0, y1, 0, 1);
    const Polygon wall{{0, 0, z0}, {0, 1, z0}, {0, 1, z1}, {0, 0, z1}};
    EXPECT_NEAR(polygon_to_polygon(floor, wall), t.factor, 2e-15) << t.horizontal << " " << t.vertical;
    EXPECT_NEAR(factors_between(triangles(floor), triangles(wall))[0], t.factor, tolerance)
        << t.horizontal << " " << t.vertical << " " << t.offset;
  }
}

// Round shapes of facets: the facets' own factor is met at once, the circle's as the inverse square of their number.
TEST(PublishedFactors, CoaxialDiscs) {
  constexpr std::array<std::array<double, 3>, 8> targets{{{0.2, 0.2, 0.037087982163740},
                                                          {0.8, 0.8, 0.307190448116156},
                                                          {1, 1, 0.381966011250105},
                                                          {2, 2, 0.609611796797792},
                                                          {5, 5, 0.819002487577582},
                                                          {8, 8, 0.882568597329052},
                                                          {0.2, 10, 0.990095126032656},
                                                          {10, 2, 0.039587804026310}}};
  for (const auto& [lower_radius, upper_radius, factor] : targets) {
    std::array<double, 2> error{};
    for (const int doubled : {0, 1}) {
      const int corners = 24 << doubled;
      const Polygon lower = floor_disk(lower_radius, 0, corners),
                    upper = reversed(floor_disk(upper_radius, 1, corners));
      const double of_facets = polygon_to_polygon(lower, upper);
      EXPECT_NEAR(factors_between(fan(lower), fan(upper))[0], of_facets, tolerance) << lower_radius;
      error[static_cast<std::size_t>(doubled)] = std::abs(of_facets - factor);
      EXPECT_LE(std::abs(of_facets / factor - 1), 14.0 / (corners * corners)) << lower_radius << " " << corners;
    }
    EXPECT_NEAR(error[0] / error[1], 4, 0.4) << lower_radius << " " << upper_radius;
  }
}

TEST(PublishedFactors, ConcentricSpheres) {
  struct Target {
    double inner, outer, wrong;  // wrong: what is published for outer to inner
  };
  for (const Target& t : {Target{1, 1.5, 2.0 / 3}, Target{2, 3, 2.0 / 3}, Target{1, 3, 1.0 / 3}}) {
    // Facets of the same tessellation: areas are in the ratio of the squared radii, whatever their number.
    const auto inner = shape_polygons(Sphere{Vec3d(0), t.inner}, 12);
    const auto outer = reversed(shape_polygons(Sphere{Vec3d(0), t.outer}, 12));
    const auto [out, in] = factors_between(inner, outer);
    EXPECT_NEAR(out, 1, tolerance);
    EXPECT_NEAR(in, t.inner * t.inner / (t.outer * t.outer), tolerance);
    EXPECT_GT(std::abs(in - t.wrong), 0.2);
  }
}

}  // namespace
}  // namespace penumbra
