// Every case of tests/data/radiosity/view_factors_analytic.json, by the exact rules for polygons: polygons themselves,
// curved surfaces as ever finer polygons, endless strips as ever longer ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/math/quadrature.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "radiosity/polygon_makers.h"
#include "test_paths.h"

namespace penumbra {
namespace {

using nlohmann::json;

const Vec3d up(0, 0, 1);

const std::vector<json>& catalogue() {
  static const std::vector<json> cases = [] {
    std::ifstream file(PENUMBRA_TEST_DATA "/radiosity/view_factors_analytic.json");
    return json::parse(file).at("cases").get<std::vector<json>>();
  }();
  return cases;
}

bool starts_with(const json& c, const std::string& prefix) { return c["id"].get<std::string>().rfind(prefix, 0) == 0; }

/// Calls `check(parameters, value, id)` for the cases whose id starts with `prefix`, and insists on how many there are.
void for_cases(const std::string& prefix, int count,
               const std::function<void(const json&, double, const std::string&)>& check) {
  int found = 0;
  for (const json& c : catalogue()) {
    if (!starts_with(c, prefix)) continue;
    SCOPED_TRACE(c["id"].get<std::string>());
    check(c["params"], c["value"].get<double>(), c["id"].get<std::string>());
    ++found;
  }
  EXPECT_EQ(found, count) << prefix;
}

/// Expects `measure(n)` to reach `truth` as n^-order, and the extrapolation from 2 n and 4 n to lie within 1e-4.
void expect_convergence(const std::function<double(int)>& measure, int n, double order, double truth) {
  const double coarse = measure(n), middle = measure(2 * n), fine = measure(4 * n);
  const double seen = 0.5 * std::log2(std::abs(coarse - truth) / std::abs(fine - truth));
  if (std::abs(fine - truth) > 1e-9) {
    EXPECT_GT(seen, order - 0.25) << coarse - truth << ' ' << middle - truth << ' ' << fine - truth;
    EXPECT_LT(seen, order + 0.6) << coarse - truth << ' ' << middle - truth << ' ' << fine - truth;
  }
  const double extrapolated = fine + (fine - middle) / (std::pow(2, order) - 1);
  EXPECT_NEAR(extrapolated, truth, 1e-4);
}

double total_exchange(const std::vector<Polygon>& from, const std::vector<Polygon>& to) {
  ExchangeAreaScratch scratch;
  double sum = 0;
  for (const Polygon& a : from) {
    for (const Polygon& b : to) sum += exchange_area(a, b, scratch);
  }
  return sum;
}

double area(const std::vector<Polygon>& all) {
  double sum = 0;
  for (const Polygon& p : all) sum += polygon_area(p);
  return sum;
}

/// A polyhedron inscribed in a sphere about the z axis, fronts outwards, n around and n / 2 from pole to pole between
/// the polar angles (from +z). Facet k + n * band: with n-fold symmetry those of one k stand for all.
std::vector<Polygon> sphere(double radius, double height, int n, double polar0 = 0, double polar1 = M_PI,
                            int bands = 0) {
  if (bands == 0) bands = n / 2;
  std::vector<Polygon> all;
  for (int k = 0; k < bands; ++k) {
    const double a = polar1 + (polar0 - polar1) * k / bands, b = polar1 + (polar0 - polar1) * (k + 1) / bands;
    const double lower = a > M_PI - 1e-12 ? 0 : radius * std::sin(a), upper = b < 1e-12 ? 0 : radius * std::sin(b);
    for (const Polygon& p :
         outward_band(lower, height + radius * std::cos(a), upper, height + radius * std::cos(b), n)) {
      all.push_back(p);
    }
  }
  return all;
}

/// Of surfaces with n-fold symmetry about z, listed band by band, one n-th.
std::vector<Polygon> one_sector(const std::vector<Polygon>& all, int n) {
  std::vector<Polygon> some;
  for (std::size_t k = 0; k < all.size(); k += static_cast<std::size_t>(n)) some.push_back(all[k]);
  return some;
}

TEST(ViewFactorCatalogue, HoldsNinetyOneCases) { EXPECT_EQ(catalogue().size(), 91U); }

TEST(ViewFactorCatalogue, ParallelRectangles) {
  for_cases("C11_", 5, [](const json& p, double value, const std::string&) {
    const double a = p["a"], b = p["b"];
    const Polygon floor = floor_rectangle(0, a, 0, b), ceiling = reversed(floor_rectangle(0, a, 0, b, p["c"]));
    EXPECT_NEAR(polygon_to_polygon(floor, ceiling), value, 1e-13);
  });
  for_cases("C13_", 4, [](const json& p, double value, const std::string&) {
    const auto x1 = p["rect1_x"], y1 = p["rect1_y"], x2 = p["rect2_x"], y2 = p["rect2_y"];
    const Polygon floor = floor_rectangle(x1[0], x1[1], y1[0], y1[1]);
    const Polygon ceiling = reversed(floor_rectangle(x2[0], x2[1], y2[0], y2[1], p["z"]));
    EXPECT_NEAR(polygon_to_polygon(floor, ceiling), value, 1e-13);
  });
}

TEST(ViewFactorCatalogue, PerpendicularRectangles) {
  for_cases("C14_", 4, [](const json& p, double value, const std::string&) {
    const double l = p["l"], w = p["w"], h = p["h"];
    const Polygon floor = floor_rectangle(0, w, 0, l), wall{{0, 0, 0}, {0, l, 0}, {0, l, h}, {0, 0, h}};
    EXPECT_NEAR(polygon_to_polygon(floor, wall), value, 1e-13);
  });
  for_cases("C15_", 3, [](const json& p, double value, const std::string&) {
    const auto x = p["rect1_x"], y = p["rect1_y"];
    const double z0 = p["rect2_z"][0], z1 = p["rect2_z"][1], y0 = p["rect2_y"][0], y1 = p["rect2_y"][1];
    const Polygon floor = floor_rectangle(x[0], x[1], y[0], y[1]),
                  wall{{0, y0, z0}, {0, y1, z0}, {0, y1, z1}, {0, y0, z1}};
    EXPECT_NEAR(polygon_to_polygon(floor, wall), value, 1e-13);
  });
}

TEST(ViewFactorCatalogue, InclinedSquares) {
  for_cases("C16_", 4, [](const json& p, double value, const std::string&) {
    const double angle = p["angle_deg"].get<double>() * M_PI / 180, c = std::cos(angle), s = std::sin(angle);
    const Polygon floor = floor_rectangle(0, 1, 0, 1), flap{{0, 0, 0}, {0, 1, 0}, {c, 1, s}, {c, 0, s}};
    EXPECT_NEAR(polygon_to_polygon(floor, flap), value, 1e-13);
  });
}

TEST(ViewFactorCatalogue, RegularSolids) {
  for_cases("tetrahedron_face_face", 1, [](const json&, double value, const std::string&) {
    const Vec3d a(1, 1, 1), b(1, -1, -1), c(-1, 1, -1), d(-1, -1, 1);
    const Polygon faces[] = {{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}};
    const bool inwards = dot(polygon_normal(faces[0]), d - a) > 0;
    for (const Polygon& from : faces) {
      for (const Polygon& to : faces) {
        if (&from == &to) continue;
        const double f = inwards ? polygon_to_polygon(from, to) : polygon_to_polygon(reversed(from), reversed(to));
        EXPECT_NEAR(f, value, 1e-13);
      }
    }
  });
  for_cases("octahedron_", 3, [](const json&, double value, const std::string& id) {
    const auto face = [](double sx, double sy, double sz) {
      Polygon p{{sx, 0, 0}, {0, sy, 0}, {0, 0, sz}};
      return dot(polygon_normal(p), p[0]) < 0 ? p : reversed(p);
    };
    const Polygon to = id == "octahedron_edge"     ? face(1, 1, -1)
                       : id == "octahedron_vertex" ? face(1, -1, -1)
                                                   : face(-1, -1, -1);
    EXPECT_NEAR(polygon_to_polygon(face(1, 1, 1), to), value, 1e-13);
  });
}

TEST(ViewFactorCatalogue, ElementToRectangle) {
  for_cases("B3_pt_rect_par", 2, [](const json& p, double value, const std::string&) {
    const Polygon ceiling = reversed(floor_rectangle(0, p["a"], 0, p["b"], p["c"]));
    EXPECT_NEAR(point_to_polygon(Vec3d(0), up, ceiling), value, 1e-15);
  });
  for_cases("B4_pt_rect_perp", 2, [](const json& p, double value, const std::string&) {
    const double a = p["a"], b = p["b"], c = p["c"];
    const Polygon wall{{c, 0, 0}, {c, 0, a}, {c, b, a}, {c, b, 0}};
    EXPECT_NEAR(point_to_polygon(Vec3d(0), up, wall), value, 1e-15);
  });
}

TEST(ViewFactorCatalogue, CoaxialDisks) {
  for_cases("C41_", 5, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      return polygon_to_polygon(floor_disk(p["r1"], 0, n), reversed(floor_disk(p["r2"], p["h"], n)));
    };
    expect_convergence(with, 16, 2, value);
  });
}

TEST(ViewFactorCatalogue, ElementToDisk) {
  for_cases("B13_", 3, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      return point_to_polygon(Vec3d(p["a"], 0, 0), up, reversed(floor_disk(p["r"], p["h"], n)));
    };
    expect_convergence(with, 32, 2, value);
  });
}

TEST(ViewFactorCatalogue, ElementToSphere) {
  for_cases("B_pt_sphere", 6, [](const json& p, double value, const std::string&) {
    // The element turns about the x axis; the sphere stands above it.
    const double angle = p["angle_deg"].get<double>() * M_PI / 180;
    const Vec3d normal(0, std::sin(angle), std::cos(angle));
    const auto with = [&](int n) {
      double sum = 0;
      for (const Polygon& facet : sphere(1, p["H"], n)) sum += point_to_polygon(Vec3d(0), normal, facet);
      return sum;
    };
    // The silhouette of a polyhedron jumps from edge to edge, so the order is only seen roughly.
    const double fine = with(512);
    EXPECT_NEAR(fine, value, 1e-4);
    EXPECT_LT(std::abs(fine - value), std::abs(with(64) - value) / 20);
  });
}

TEST(ViewFactorCatalogue, SphereToPolygon) {
  for_cases("C_sphere_to_coax_disk", 2, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      const auto ball = sphere(0.5, p["h"], n);
      return n * total_exchange(one_sector(ball, n), {floor_disk(p["r"], 0, n)}) / area(ball);
    };
    expect_convergence(with, 16, 2, value);
  });
  for_cases("C_sphere_to_rect", 2, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      const double d = p["d"];
      const auto ball = sphere(0.5 * d, d, n);
      return total_exchange(ball, {floor_rectangle(0, p["l1"], 0, p["l2"])}) / area(ball);
    };
    expect_convergence(with, 16, 2, value);
  });
  for_cases("C_disk_to_sphere", 2, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      const Polygon disk = floor_disk(p["R"], 0, n);
      return n * total_exchange(one_sector(sphere(p["r"], p["d"], n), n), {disk}) / polygon_area(disk);
    };
    expect_convergence(with, 16, 2, value);
  });
}

TEST(ViewFactorCatalogue, SphereToSphere) {
  for_cases("C_sphere_sphere", 3, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      const auto from = sphere(p["r1"], 0, n), to = sphere(p["r2"], p["d"], n);
      return n * total_exchange(one_sector(from, n), to) / area(from);
    };
    expect_convergence(with, 16, 2, value);
  });
}

TEST(ViewFactorCatalogue, CoaxialCylindersFacingEachOther) {
  for_cases("C91_coax_cyl_out_in", 4, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      const auto inner = outward_band(p["r1"], 0, p["r1"], p["H"], n);
      const auto outer = reversed(outward_band(p["r2"], 0, p["r2"], p["H"], n));
      return n * total_exchange(one_sector(inner, n), outer) / area(outer);
    };
    expect_convergence(with, 32, 2, value);
  });
  for_cases("C91_coax_cyl_in_out", 4, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      const auto inner = outward_band(p["r1"], 0, p["r1"], p["H"], n);
      const auto outer = reversed(outward_band(p["r2"], 0, p["r2"], p["H"], n));
      return n * total_exchange(one_sector(inner, n), outer) / area(inner);
    };
    expect_convergence(with, 32, 2, value);
  });
}

/// Factor from a point of the outer wall to the rest of it past the inner prism of the same length. Within that length
/// only the plan counts: the prism hides what lies between the two vertical planes through the point that touch it.
double past_prism(const Vec3d& point, const Vec3d& normal, const std::vector<Polygon>& wall, const Polygon& prism) {
  Plane3 left, right;  // half-spaces beside the prism
  for (const Vec3d& corner : prism) {
    const Vec3d d(corner.x - point.x, corner.y - point.y, 0);
    const Vec3d side = normalize(cross(up, d));
    const auto touches = [&](double sign) {
      return std::all_of(prism.begin(), prism.end(),
                         [&](const Vec3d& q) { return sign * dot(side, q - point) <= 1e-12; });
    };
    if (touches(1)) left = {side, dot(side, point)};
    if (touches(-1)) right = {-side, -dot(side, point)};
  }
  double sum = 0;
  std::vector<Vec3d> part;
  for (const Polygon& facet : wall) {
    for (const Plane3& beside : {left, right}) {
      clip_polygon(facet, beside, 0, part);
      sum += point_to_polygon(point, normal, part);
    }
  }
  return sum;
}

TEST(ViewFactorCatalogue, OuterCylinderToItselfPastTheInner) {
  for_cases("C91_coax_cyl_out_self", 4, [](const json& p, double value, const std::string&) {
    const double length = p["H"];
    const auto with = [&](int n) {
      const Polygon prism = floor_disk(p["r1"], 0, n);
      const auto wall = reversed(outward_band(p["r2"], 0, p["r2"], length, n));
      double sum = 0;
      for (const GaussNode& u : gauss_legendre(6)) {
        for (const GaussNode& v : gauss_legendre(32)) {  // half the height: the other half mirrors it
          const Vec3d foot = (1 - u.x) * wall[0][0] + u.x * wall[0][1];
          const Vec3d point(foot.x, foot.y, 0.5 * length * v.x);
          sum += u.weight * v.weight * past_prism(point, polygon_normal(wall[0]), wall, prism);
        }
      }
      return sum;
    };
    expect_convergence(with, 16, 2, value);
  });
}

TEST(ViewFactorCatalogue, ClosedCylinder) {
  for_cases("cyl_base_to_base", 3, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      return polygon_to_polygon(floor_disk(p["r"], 0, n), reversed(floor_disk(p["r"], p["h"], n)));
    };
    expect_convergence(with, 16, 2, value);
  });
  for_cases("cyl_wall_to_base", 3, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      const auto wall = reversed(outward_band(p["r"], 0, p["r"], p["h"], n));
      return polygon_to_polygon(wall[0], floor_disk(p["r"], 0, n));
    };
    expect_convergence(with, 16, 2, value);
  });
  for_cases("cyl_wall_self", 3, [](const json& p, double value, const std::string&) {
    const auto with = [&](int n) {
      const auto wall = reversed(outward_band(p["r"], 0, p["r"], p["h"], n));
      return total_exchange({wall[0]}, wall) / polygon_area(wall[0]);
    };
    expect_convergence(with, 16, 2, value);
  });
}

TEST(ViewFactorCatalogue, InsideOfACone) {
  for_cases("cone_self", 3, [](const json& p, double value, const std::string&) {
    const double half_angle = p["half_angle_deg"].get<double>() * M_PI / 180;
    const auto with = [&](int n) {
      const auto wall = reversed(outward_band(0, 0, std::tan(half_angle), 1, n));
      const double self = total_exchange({wall[0]}, wall) / polygon_area(wall[0]);
      // The polygonal truth: whatever leaves the wall and misses it leaves through the opening.
      EXPECT_NEAR(self, 1 - polygon_area(floor_disk(std::tan(half_angle), 1, n)) / area(wall), 1e-12);
      return self;
    };
    expect_convergence(with, 16, 2, value);
  });
}

TEST(ViewFactorCatalogue, InsideOfAHemisphere) {
  for_cases("hemisphere_self", 1, [](const json&, double value, const std::string&) {
    const auto with = [](int n) {
      const auto bowl = reversed(sphere(1, 0, n, 0, M_PI / 2, n / 4));
      const double self = n * total_exchange(one_sector(bowl, n), bowl) / area(bowl);
      EXPECT_NEAR(self, 1 - polygon_area(floor_disk(1, 0, n)) / area(bowl), 1e-11);
      return self;
    };
    expect_convergence(with, 8, 2, value);
  });
}

TEST(ViewFactorCatalogue, ConcentricSpheres) {
  const auto out_in = [](const json& p, int n) {
    const auto inner = sphere(p["r1"], 0, n), outer = reversed(sphere(p["r2"], 0, n));
    const double from_inner = n * total_exchange(one_sector(inner, n), outer);
    EXPECT_NEAR(from_inner / area(inner), 1, 1e-9);  // all that leaves the inner one arrives
    return from_inner / area(outer);
  };
  for_cases("conc_spheres_out_in", 2, [&](const json& p, double value, const std::string&) {
    // Both are inscribed, so that the ratio of their areas is that of the spheres at every n.
    EXPECT_NEAR(out_in(p, 16), value, 1e-9);
  });
  for_cases("conc_spheres_out_self", 2, [&](const json& p, double value, const std::string&) {
    EXPECT_NEAR(1 - out_in(p, 16), value, 1e-9);  // by closure: the inner sphere is in the way
  });
}

TEST(ViewFactorCatalogue, EndlessPlates) {
  for_cases("2D_par_plates", 2, [](const json& p, double value, const std::string&) {
    const auto with = [&](int length) {
      return polygon_to_polygon(floor_rectangle(0, p["w"], 0, length),
                                reversed(floor_rectangle(0, p["w"], 0, length, p["h"])));
    };
    expect_convergence(with, 100, 1, value);
  });
  for_cases("2D_perp_plates", 2, [](const json& p, double value, const std::string&) {
    const double w = p["w"], h = p["h"];
    const auto with = [&](int length) {
      const double l = length;
      return polygon_to_polygon(floor_rectangle(0, w, 0, l), Polygon{{0, 0, 0}, {0, l, 0}, {0, l, h}, {0, 0, h}});
    };
    expect_convergence(with, 100, 1, value);
  });
  for_cases("2D_vgroove", 3, [](const json& p, double value, const std::string&) {
    const double angle = p["angle_deg"].get<double>() * M_PI / 180, c = std::cos(angle), s = std::sin(angle);
    const auto with = [&](int length) {
      const double l = length;
      return polygon_to_polygon(floor_rectangle(0, 1, 0, l), Polygon{{0, 0, 0}, {0, l, 0}, {c, l, s}, {c, 0, s}});
    };
    expect_convergence(with, 100, 1, value);
  });
}

TEST(ViewFactorCatalogue, EndlessCylinders) {
  for_cases("2D_parallel_cyl", 2, [](const json& p, double value, const std::string&) {
    const double r = p["r"], apart = 2 * r + p["s"].get<double>();
    const auto of_length = [&](int n, double length) {
      const auto from = outward_band(r, 0, r, length, n);
      std::vector<Polygon> to;
      for (const Polygon& side : from) to.push_back(moved(side, {apart, 0, 0}));
      return total_exchange(from, to) / area(from);
    };
    // The 1/length of finite cylinders is taken out first, then the corners of the prisms go.
    const auto with = [&](int n) { return 2 * of_length(n, 4000) - of_length(n, 2000); };
    expect_convergence(with, 16, 2, value);
    expect_convergence([&](int length) { return of_length(64, length); }, 250, 1, with(64));
  });
}

TEST(ViewFactorCatalogue, PlaneToARowOfCylinders) {
  for_cases("2D_plane_to_cyl_row", 2, [](const json& p, double value, const std::string&) {
    const double radius = 0.5 * p["D"].get<double>(), pitch = p["s"], height = 2 * radius;
    // From a point of the plane z = 0 the cylinders cover intervals of angle from the normal; merged, each is seen like
    // an endless strip across it.
    const auto covered = [&](double x) {
      std::vector<std::pair<double, double>> intervals;
      for (int k = -2000; k <= 2000; ++k) {
        const double dx = k * pitch - x, middle = std::atan2(dx, height),
                     half = std::asin(radius / std::hypot(dx, height));
        intervals.emplace_back(middle - half, std::min(middle + half, M_PI / 2 - 1e-9));
      }
      std::sort(intervals.begin(), intervals.end());
      double sum = 0, from = intervals[0].first, to = intervals[0].second;
      const auto add = [&] {
        const double x0 = std::tan(std::max(from, -M_PI / 2 + 1e-9)), x1 = std::tan(to), far = 1e10;
        sum += point_to_polygon(Vec3d(0), up, reversed(floor_rectangle(x0, x1, -far, far, 1)));
      };
      for (const auto& [a, b] : intervals) {
        if (a > to) {
          add();
          from = a;
        }
        to = std::max(to, b);
      }
      add();
      return sum;
    };
    // Midpoint rule over one period of a periodic function with kinks: second order.
    const int points = 256;
    double mean = 0;
    for (int k = 0; k < points; ++k) mean += covered((k + 0.5) * pitch / points) / points;
    EXPECT_NEAR(mean, value, 1e-4);
  });
}

}  // namespace
}  // namespace penumbra
