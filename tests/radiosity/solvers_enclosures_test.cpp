// Enclosures whose radiosity is known in closed form or as a converged integral equation: each within a discretisation
// error that shrinks at its order.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "penumbra/math/quadrature.h"
#include "penumbra/radiosity/form_factors/normalization.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/solvers/direct.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/radiosity/solvers/gauss_seidel.h"
#include "penumbra/radiosity/solvers/progressive.h"
#include "penumbra/radiosity/solvers/solver.h"
#include "penumbra/scene/builtin_scenes.h"
#include "radiosity/enclosure_table.h"
#include "radiosity/enclosures.h"
#include "radiosity/round_cavities.h"

namespace penumbra {
namespace {

using test::convex_factors;
using test::disk_exchange;
using test::element_mesh;
using test::enclosure_table;
using test::grid;
using test::sparse;
using test::sphere_facets;
using test::uniform_problem;

constexpr double pi = std::numbers::pi;

SolverOptions strict() {
  SolverOptions options;
  options.tolerance = 1e-13;
  options.stop_at = 1;
  return options;
}

/// How far a discretised solution is from the truth.
using ErrorAt = std::function<double(int resolution)>;

/// Halving the elements divides the error by at least `ratio`, down to `least` at the finest.
void expect_convergence(const ErrorAt& error, std::initializer_list<int> resolutions, double ratio, double least,
                        const std::string& what) {
  double last = -1;
  for (const int n : resolutions) {
    const double now = error(n);
    if (last >= 0) {
      EXPECT_LT(now * ratio, last) << what << " at " << n << ": " << now;
    }
    last = now;
  }
  EXPECT_LT(last, least) << what;
}

// The built-in furnace is not convex: some of it hides behind a box. Once its rows are closed it is uniform to
// rounding, bounce by bounce.
TEST(Enclosures, EveryBounceOfTheBuiltInFurnace) {
  const PatchMesh mesh = make_patch_mesh(make_builtin_scene("furnace"), {}).mesh;
  FormFactorOptions options;
  options.tolerance = 1e-3;
  FactorMatrix factors = assemble_factor_matrix(*make_form_factor_method("adaptive", mesh, options), mesh);
  normalize_least_squares(factors);
  for (const auto& c : enclosure_table()["furnace"]["cases"]) {
    const double rho = c["rho"], e = c["E"], b = c["B"];
    const RadiosityProblem problem = uniform_problem(factors.areas, 3, rho, e);
    for (const std::string_view name : solver_names()) {
      for (const double found : solve_radiosity(name, problem, factors, strict()).radiosity) {
        EXPECT_NEAR(found, b, 1e-9 * b) << name;
      }
    }
    if (!c.contains("partial_sums")) continue;
    SolverOptions bounces = strict();
    bounces.tolerance = 0;
    bounces.max_iterations = 10;
    std::size_t checked = 0;
    bounces.on_stage = [&](const SolverStage& stage) {
      const std::string k = std::to_string(stage.iteration);
      if (!c["partial_sums"].contains(k)) return;
      ++checked;
      for (const double found : stage.radiosity) EXPECT_NEAR(found, c["partial_sums"][k].get<double>(), 1e-9 * b) << k;
    };
    (void)solve_progressive(problem, factors, bounces);
    EXPECT_EQ(checked, std::size_t{4});
  }
}

TEST(Enclosures, TwoPatches) {
  const std::vector<Polygon> opposed{floor_rectangle(0, 1, 0, 1), reversed(floor_rectangle(0, 1, 0, 1, 1))};
  const std::vector<Polygon> perpendicular{floor_rectangle(0, 1, 0, 1), {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}};
  std::size_t checked = 0;
  for (const auto& c : enclosure_table()["two_patches"]["cases"]) {
    const std::string geometry = c["geometry"];
    const bool known = geometry == "opposed unit squares gap 1" || geometry == "perpendicular unit squares";
    if (!known) continue;
    ++checked;
    const FactorMatrix factors = convex_factors(element_mesh(geometry[0] == 'o' ? opposed : perpendicular));
    RadiosityProblem problem = uniform_problem(factors.areas, 1, 0, 0);
    problem.emission = {c["E1"], c["E2"]};
    problem.reflectance = {c["rho1"], c["rho2"]};
    for (const std::string_view name : solver_names()) {
      const auto b = solve_radiosity(name, problem, factors, strict()).radiosity;
      EXPECT_NEAR(b[0], c["B1"].get<double>(), 1e-10) << name << geometry;
      EXPECT_NEAR(b[1], c["B2"].get<double>(), 1e-10) << name << geometry;
    }
  }
  EXPECT_GE(checked, std::size_t{3});
}

// Cold gas between plates takes part of what crosses: the factor is the transmittance.
TEST(Enclosures, PlatesWithAnAbsorbingSlabBetween) {
  for (const auto& c : enclosure_table()["absorbing_slab_between_plates"]["cases"]) {
    const double t = c["T"];
    RadiosityProblem problem = uniform_problem({1, 1}, 1, c["rho"], 0);
    problem.emission = {c["E1"], c["E2"]};
    const auto b = solve_gauss_seidel(problem, sparse({1, 1}, {{0, t}, {t, 0}}), strict()).radiosity;
    EXPECT_NEAR(b[0], c["B1"].get<double>(), 1e-10);
    EXPECT_NEAR(b[1], c["B2"].get<double>(), 1e-10);
  }
}

/// A whole sphere of n rings with the factors of its facets.
const std::pair<PatchMesh, FactorMatrix>& whole_sphere(int n) {
  static std::map<int, std::pair<PatchMesh, FactorMatrix>> spheres;
  auto& sphere = spheres[n];
  if (sphere.second.rows() == 0) {
    sphere.first = element_mesh(sphere_facets(1, 0, pi, n, 2 * n));
    sphere.second = convex_factors(sphere.first);
  }
  return sphere;
}

/// The largest |B - truth| over the elements of a sphere with emission and reflectance given along the axis.
double patterned_sphere_error(int n, const std::function<double(double)>& emission,
                              const std::function<double(double)>& reflectance, double beta) {
  const auto& [mesh, factors] = whole_sphere(n);
  RadiosityProblem problem = uniform_problem(factors.areas, 1, 0, 0);
  for (std::size_t i = 0; i < mesh.patch_count(); ++i) {
    const double z = mesh.centroids[i].z / length(mesh.centroids[i]);
    problem.emission[i] = emission(z);
    problem.reflectance[i] = reflectance(z);
  }
  const auto solution = solve_gauss_seidel(problem, factors, strict());
  double worst = 0;
  for (const double h : solution.irradiance) worst = std::max(worst, std::abs(h - beta) / beta);
  return worst;
}

// Inside a sphere all see all alike: the irradiance is the same everywhere, whatever the pattern.
TEST(Enclosures, SpheresOfAnyPattern) {
  const auto& cases = enclosure_table()["sphere_any_pattern"]["cases"];
  const std::function<double(double)> half = [](double) { return 0.5; };
  expect_convergence(
      [&](int n) {
        return patterned_sphere_error(
            n, [](double z) { return std::max(0.0, z); }, half, cases[0]["beta"]);
      },
      {5, 10, 20}, 3, 0.03, "half lit");
  expect_convergence(
      [&](int n) {
        return patterned_sphere_error(
            n, [](double z) { return 1 + z; }, [](double z) { return 0.5 + 0.4 * z; }, cases[1]["beta"]);
      },
      {5, 10, 20}, 3, 0.03, "patterned");
}

// A lamp anywhere inside: its direct light may fall as it will, the indirect light is the same everywhere.
TEST(Enclosures, ALampAnywhereInASphere) {
  const auto& c = enclosure_table()["sphere_any_pattern"]["cases"][2];
  const double flux = c["point_source_flux"], expected = c["E_indirect"];
  const Vec3d lamp(0.3, 0.2, -0.4);
  expect_convergence(
      [&](int n) {
        const auto& [mesh, factors] = whole_sphere(n);
        RadiosityProblem problem = uniform_problem(factors.areas, 1, c["rho"], 0);
        for (std::size_t i = 0; i < mesh.patch_count(); ++i) {
          const Vec3d d = mesh.centroids[i] - lamp;
          problem.irradiance.push_back(flux / (4 * pi) * -dot(d, mesh.normals[i]) / std::pow(length(d), 3));
        }
        problem.light_power = {flux};
        const auto solution = solve_gauss_seidel(problem, factors, strict());
        double worst = 0;
        for (std::size_t i = 0; i < mesh.patch_count(); ++i) {
          worst = std::max(worst, std::abs(solution.irradiance[i] - problem.irradiance[i] - expected) / expected);
        }
        return worst;
      },
      {5, 10, 20}, 3, 0.03, "lamp");
}

TEST(Enclosures, ASphericalCapClosedByADisk) {
  for (const auto& c : enclosure_table()["spherical_cap_with_flat_base"]["cases"]) {
    const double b = c["b_deg"].get<double>() * pi / 180;
    expect_convergence(
        [&](int n) {
          std::vector<Polygon> elements = sphere_facets(1, 0, b, n, 4 * n);
          elements.push_back(floor_disk(std::sin(b), std::cos(b), 4 * n));
          const FactorMatrix factors = convex_factors(element_mesh(elements));
          RadiosityProblem problem = uniform_problem(factors.areas, 1, c["rc"], c["Ec"]);
          problem.reflectance.back() = c["rb"];
          problem.emission.back() = c["Eb"];
          const auto found = solve_gauss_seidel(problem, factors, strict()).radiosity;
          double worst = std::abs(found.back() / c["Bb"].get<double>() - 1);
          for (std::size_t i = 0; i + 1 < found.size(); ++i) {
            worst = std::max(worst, std::abs(found[i] / c["Bc"].get<double>() - 1));
          }
          return worst;
        },
        {4, 8}, 3, 0.03, "cap of " + c["b_deg"].dump() + " degrees");
  }
}

// A hole in a sphere looks brighter the smaller it is.
TEST(Enclosures, SphericalCavities) {
  for (const auto& c : enclosure_table()["spherical_cavity"]["cases"]) {
    const double emissivity = c["emissivity"], apparent = c["apparent"];
    const double opening = c["phi_deg"].get<double>() * pi / 180;
    expect_convergence(
        [&](int n) {
          const FactorMatrix factors = convex_factors(element_mesh(sphere_facets(1, opening, pi, n, 2 * n)));
          const auto found =
              solve_gauss_seidel(uniform_problem(factors.areas, 1, 1 - emissivity, emissivity), factors, strict());
          double worst = 0;
          for (const double b : found.radiosity) worst = std::max(worst, std::abs(b / apparent - 1));
          return worst;
        },
        {6, 12}, 3, 0.01, "opening of " + c["phi_deg"].dump() + " degrees");
  }
}

// The inner sphere hides part of the outer one from itself.
TEST(Enclosures, ConcentricSpheres) {
  for (const auto& c : enclosure_table()["concentric_spheres"]["cases"]) {
    const double r1 = c["r1"], r2 = c["r2"], back = r1 * r1 / (r2 * r2);
    RadiosityProblem pair = uniform_problem({r1 * r1, r2 * r2}, 1, 0, 0);
    pair.reflectance = {c["rho1"], c["rho2"]};
    pair.emission = {c["E1"], c["E2"]};
    const auto two = solve_gauss_seidel(pair, sparse(pair.areas, {{0, 1}, {back, 1 - back}}), strict()).radiosity;
    EXPECT_NEAR(two[0], c["B1"].get<double>(), 1e-10);
    EXPECT_NEAR(two[1], c["B2"].get<double>(), 1e-10);
    if (r2 / r1 < 1.5) continue;  // facets of nearly touching spheres would cross
    const auto error = [&](int n) {
      std::vector<Polygon> elements = reversed(sphere_facets(r1, 0, pi, n, 2 * n));
      const std::size_t inner = elements.size();
      for (Polygon& p : sphere_facets(r2, 0, pi, n, 2 * n)) elements.push_back(std::move(p));
      const PatchMesh mesh = element_mesh(elements);
      FormFactorOptions options;
      options.tolerance = 3e-3;
      const FactorMatrix factors = assemble_factor_matrix(*make_form_factor_method("auto", mesh, options), mesh);
      RadiosityProblem problem = uniform_problem(factors.areas, 1, c["rho2"], c["E2"]);
      std::fill_n(problem.reflectance.begin(), inner, c["rho1"].get<double>());
      std::fill_n(problem.emission.begin(), inner, c["E1"].get<double>());
      const auto found = solve_gauss_seidel(problem, factors, strict()).radiosity;
      double worst = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        worst = std::max(worst, std::abs(found[i] / c[i < inner ? "B1" : "B2"].get<double>() - 1));
      }
      return worst;
    };
    expect_convergence(error, {4, 8}, 1.7, 0.02, "spheres of " + c["r2"].dump());
  }
}

/// The room of the unit cube: floor, ceiling, four walls, n x n elements each where nothing else is said.
struct CubeRoom {
  PatchMesh mesh;
  FactorMatrix factors;
  explicit CubeRoom(const std::vector<Polygon>& elements)
      : mesh(element_mesh(elements)), factors(convex_factors(mesh)) {}
  explicit CubeRoom(int n) : CubeRoom(test::room_elements({1, 1, 1}, n)) {}

  // What a point receives from all elements: one exact gather more than the solution (Sloan's iterate).
  [[nodiscard]] double irradiance(const Vec3d& point, const Vec3d& normal, const std::vector<double>& radiosity) const {
    double sum = 0;
    for (std::size_t j = 0; j < mesh.patch_count(); ++j) {
      sum += radiosity[j] * point_to_polygon(point, normal, mesh.polygon(j));
    }
    return sum;
  }
};

const CubeRoom& cube_room(int n) {
  static std::map<int, CubeRoom> rooms;
  return rooms.try_emplace(n, n).first->second;
}

TEST(Enclosures, CubeRoomAtItsPoints) {
  for (const auto& c : enclosure_table()["unit_cube_room_ceiling_emitter"]["cases"]) {
    const auto solve = [&](int n) {
      const auto per_face = static_cast<std::size_t>(n * n);
      RadiosityProblem problem = uniform_problem(cube_room(n).factors.areas, 1, c["rho_walls"], 0);
      for (std::size_t i = 0; i < 2 * per_face; ++i) {
        problem.reflectance[i] = i < per_face ? c["rho_floor"] : c["rho_ceiling"];
        problem.emission[i] = i < per_face ? 0.0 : c["emission_ceiling_radiosity"].get<double>();
      }
      return solve_gauss_seidel(problem, cube_room(n).factors, strict());
    };
    const auto six = solve(1).radiosity;
    EXPECT_NEAR(six[0], c["six_patch_constant_radiosity"]["floor"].get<double>(), 1e-9);
    EXPECT_NEAR(six[1], c["six_patch_constant_radiosity"]["ceiling"].get<double>(), 1e-9);
    for (std::size_t w = 2; w < 6; ++w) {
      EXPECT_NEAR(six[w], c["six_patch_constant_radiosity"]["wall"].get<double>(), 1e-9);
    }
    const auto error = [&](int n) {
      const auto b = solve(n).radiosity;
      double worst = 0;
      for (const auto& p : c["points"]) {
        const double u = p["u"], v = p["v"];
        const std::string face = p["face"];
        double found = 0;
        if (face == "f") found = c["rho_floor"].get<double>() * cube_room(n).irradiance({u, v, 0}, {0, 0, 1}, b);
        if (face == "w") found = c["rho_walls"].get<double>() * cube_room(n).irradiance({u, 0, v}, {0, 1, 0}, b);
        if (face == "c") {
          found = 1 + c["rho_ceiling"].get<double>() * cube_room(n).irradiance({u, v, 1}, {0, 0, -1}, b);
        }
        worst = std::max(worst, std::abs(found / p["B"].get<double>() - 1));
      }
      return worst;
    };
    expect_convergence(error, {3, 6, 12}, 2.5, 2e-3, "cube room with walls of " + c["rho_walls"].dump());
  }
}

/// The unit cube with n x n elements a face whose rows are the narrower the nearer they are to the edges, as
/// Chebyshev's points: there light from the wall beside changes fastest.
CubeRoom graded_room(int n) {
  std::vector<Polygon> cells;
  const auto place = [&](int k) { return 0.5 * (1 - std::cos(pi * k / n)); };
  for (const Polygon& face : room({1, 1, 1})) {
    const auto at = [&](int i, int j) {
      return face[0] + place(i) * (face[1] - face[0]) + place(j) * (face[3] - face[0]);
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) cells.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  return CubeRoom(cells);
}

// A lamp in the middle of a cube (CIE 171, test 5.8): the mean follows from the energy, the points do not. 1176
// elements give the light that walls reflect within 1 % at every point, also 12 cm from two walls.
TEST(Enclosures, LampInACube) {
  const auto& table = enclosure_table()["cube_point_source"];
  const double edge = table["face_edge_m"], flux = 10000, half = edge / 2;
  const CubeRoom unit = graded_room(14);
  FactorMatrix factors = unit.factors;  // of a cube of edge 1: areas grow with the edge, factors do not
  for (double& a : factors.areas) a *= edge * edge;
  const auto rule = gauss_legendre(4);
  for (const auto& c : table["table"]) {
    RadiosityProblem problem = uniform_problem(factors.areas, 1, c["rho"], 0);
    for (std::size_t i = 0; i < factors.rows(); ++i) {
      double direct = 0;
      const auto corners = unit.mesh.polygon(i);
      for (const auto& u : rule) {
        for (const auto& v : rule) {
          const Vec3d p = corners[0] + u.x * (corners[1] - corners[0]) + v.x * (corners[3] - corners[0]);
          direct += u.weight * v.weight * flux / (4 * pi) * half / std::pow(edge * length(p - Vec3d(0.5)), 3);
        }
      }
      problem.irradiance.push_back(direct);
    }
    problem.light_power = {flux};
    const auto solution = solve_gauss_seidel(problem, factors, strict());
    const double mean = power_of(problem, solution.irradiance) / (6 * edge * edge);
    EXPECT_NEAR(mean, c["E_total_mean_lux"].get<double>(), 1e-6 * mean);
    for (const auto& [place, expected] : c["E_indirect_point_lux"].items()) {
      const double u = std::stod(place), v = std::stod(place.substr(place.find(',') + 1));
      const double found = unit.irradiance({u, v, 0}, {0, 0, 1}, solution.radiosity);
      EXPECT_NEAR(found, expected.get<double>(), 0.01 * expected.get<double>()) << c["rho"] << " at " << place;
    }
  }
}

/// Two opposed infinite strips of width 1 cut into n each: Hottel's crossed strings are their exact factors.
TEST(Enclosures, TwoInfiniteStrips) {
  for (const auto& c : enclosure_table()["two_infinite_strips"]["table"]) {
    const double gap = c["gap"];
    const auto error = [&](int n) {
      const auto count = static_cast<std::size_t>(n);
      const double width = 1.0 / n;
      const auto string = [&](double x) { return std::hypot(x, gap); };
      std::vector<std::vector<double>> rows(2 * count, std::vector<double>(2 * count, 0.0));
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j) {
          const double d = (static_cast<double>(i) - static_cast<double>(j)) * width;
          const double f = (string(d + width) + string(d - width) - 2 * string(d)) / (2 * width);
          rows[i][count + j] = rows[count + j][i] = f;
        }
      }
      const FactorMatrix factors = sparse(std::vector<double>(2 * count, width), rows);
      const auto b = solve_gauss_seidel(uniform_problem(factors.areas, 1, c["rho"], 1), factors, strict()).radiosity;
      double worst = 0;
      for (const auto& [place, expected] : c["B_at_x"].items()) {
        double arriving = 0;
        for (std::size_t j = 0; j < count; ++j) {
          const double from = static_cast<double>(j) * width - std::stod(place), to = from + width;
          arriving += 0.5 * (to / string(to) - from / string(from)) * b[count + j];
        }
        worst = std::max(worst, std::abs((1 + c["rho"].get<double>() * arriving) / expected.get<double>() - 1));
      }
      return worst;
    };
    expect_convergence(error, {8, 16, 32, 64}, 3, 1e-3, "gap " + c["gap"].dump());
  }
}

/// A cylindrical hole of radius 1 in rings: n on the wall for each radius of depth, n on the base. Rings see
/// themselves.
struct CylindricalCavity {
  std::vector<double> areas, to_opening, from_centre;  // the last: factors from the base's centre
  FactorMatrix factors;

  CylindricalCavity(int depth, int n) {
    const auto wall = static_cast<std::size_t>(depth * n), base = static_cast<std::size_t>(n), all = wall + base;
    const auto height = [&](std::size_t k) { return static_cast<double>(k) / n; };  // above the base
    const auto radius = height;
    const auto rings = [&](double s, std::size_t k) {  // exchange of a base disk of radius s with wall ring k
      return disk_exchange(s, 1, height(k)) - disk_exchange(s, 1, height(k + 1));
    };
    std::vector<std::vector<double>> exchange(all, std::vector<double>(all, 0.0));
    for (std::size_t i = 0; i < wall; ++i) {
      areas.push_back(2 * pi / n);
      to_opening.push_back(disk_exchange(1, 1, depth - height(i + 1)) - disk_exchange(1, 1, depth - height(i)));
      from_centre.push_back(1 / (1 + height(i) * height(i)) - 1 / (1 + height(i + 1) * height(i + 1)));
      exchange[i][i] = areas[i] - 2 * (pi - disk_exchange(1, 1, height(1)));
      for (std::size_t j = i + 1; j < wall; ++j) {
        const auto between = [&](std::size_t a, std::size_t b) { return disk_exchange(1, 1, height(b - a)); };
        exchange[i][j] = exchange[j][i] = between(i + 1, j) - between(i, j) - between(i + 1, j + 1) + between(i, j + 1);
      }
      for (std::size_t j = 0; j < base; ++j) {
        exchange[i][wall + j] = exchange[wall + j][i] = rings(radius(j + 1), i) - rings(radius(j), i);
      }
    }
    for (std::size_t j = 0; j < base; ++j) {
      areas.push_back(pi * (radius(j + 1) * radius(j + 1) - radius(j) * radius(j)));
      to_opening.push_back(disk_exchange(radius(j + 1), 1, depth) - disk_exchange(radius(j), 1, depth));
      from_centre.push_back(0);
    }
    for (std::size_t i = 0; i < all; ++i)
      for (double& x : exchange[i]) x /= areas[i];
    factors = sparse(areas, exchange);
  }
};

TEST(Enclosures, CylindricalCavities) {
  for (const auto& c : enclosure_table()["cylindrical_cavity"]["table"]) {
    const double emissivity = c["emissivity"];
    const auto solve = [&](int n) {
      const CylindricalCavity cavity(c["L_over_R"].get<int>(), n);
      const RadiosityProblem problem = uniform_problem(cavity.areas, 1, 1 - emissivity, emissivity);
      const auto b = solve_gauss_seidel(problem, cavity.factors, strict()).radiosity;
      double leaving = 0, centre = 0;
      for (std::size_t i = 0; i < b.size(); ++i) {
        leaving += b[i] * cavity.to_opening[i] / pi;
        centre += b[i] * cavity.from_centre[i];
      }
      return std::pair(leaving, emissivity + (1 - emissivity) * centre);
    };
    const std::string what = "depth " + c["L_over_R"].dump() + ", emissivity " + c["emissivity"].dump();
    expect_convergence(
        [&](int n) { return std::abs(solve(n).first / c["apparent_hemispherical_emissivity"].get<double>() - 1); },
        {4, 8, 16}, 3, 1e-4, what + ", opening");
    expect_convergence([&](int n) { return std::abs(solve(n).second / c["B_base_centre"].get<double>() - 1); },
                       {4, 8, 16}, 3, 1e-4, what + ", centre");
  }
}

/// How far the indirect light of facets in an open spherical bowl of unit radius is from what it should be, relative.
struct BowlError {
  double mean = 0, rms = 0, worst = 0;
};

/// A bowl in the sun; part of it lies in its own shadow.
BowlError bowl_error(int n, double rim, double elevation, double reflectance, double expected) {
  // The bowl is the lower part of the sphere: its rim lies at polar angle pi - rim.
  static std::map<std::pair<int, double>, std::pair<PatchMesh, FactorMatrix>> bowls;
  auto& [mesh, factors] = bowls[{n, rim}];
  if (factors.rows() == 0) {
    mesh = element_mesh(sphere_facets(1, pi - rim, pi, n, 4 * n));
    factors = convex_factors(mesh);
  }
  const Vec3d sun(std::cos(elevation), 0, std::sin(elevation));
  RadiosityProblem problem = uniform_problem(factors.areas, 1, reflectance, 0);
  constexpr int samples = 32;
  for (std::size_t i = 0; i < mesh.patch_count(); ++i) {
    double direct = 0;
    for (int s = 0; s < samples * samples; ++s) {
      const auto corners = mesh.polygon(i);
      const double u = (s % samples + 0.5) / samples, v = (s / samples + 0.5) / samples;
      const Vec3d &d = corners.back(), &a = corners[0], &b = corners[1], &e = corners[2];
      const Vec3d flat = corners.size() == 4 ? (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * e + (1 - u) * v * d
                                             : a + std::sqrt(u) * ((1 - v) * (b - a) + v * (e - a));
      const Vec3d p = flat / length(flat);
      // Towards the sun the ray meets the sphere again at p + t sun; above the rim there is none.
      const double t = -2 * dot(p, sun);
      if (t > 0 && p.z + t * sun.z < -std::cos(rim)) continue;
      direct += std::max(0.0, -dot(p, sun)) / (samples * samples);
    }
    problem.irradiance.push_back(direct);
  }
  const auto solution = solve_gauss_seidel(problem, factors, strict());
  BowlError error;
  double area = 0;
  for (std::size_t i = 0; i < mesh.patch_count(); ++i) {
    const double off = (solution.irradiance[i] - problem.irradiance[i]) / expected - 1;
    error.mean += mesh.areas[i] * off;
    error.rms += mesh.areas[i] * off * off;
    error.worst = std::max(error.worst, std::abs(off));
    area += mesh.areas[i];
  }
  return {std::abs(error.mean / area), std::sqrt(error.rms / area), error.worst};
}

// The indirect light is the same all over the bowl, in light and in shadow. Mean and root mean square fall with the
// square of the facets' size; only the worst facets, slivers about the bottom and those beside the few that a low sun
// lights, follow slower: a flat facet does not light itself as its piece of the sphere does.
TEST(Enclosures, BowlCraterInTheSun) {
  for (const auto& c : enclosure_table()["bowl_crater_collimated"]["cases"]) {
    if (!c.contains("E_indirect")) continue;  // a temperature, not light
    const double rim = c["beta_deg"].get<double>() * pi / 180, elevation = c["elev_deg"].get<double>() * pi / 180;
    const auto at = [&](int n) { return bowl_error(n, rim, elevation, c["rho"], c["E_indirect"]); };
    expect_convergence([&](int n) { return at(n).rms; }, {4, 8}, 2.8, 0.026, c.dump());
    expect_convergence([&](int n) { return at(n).worst; }, {4, 8}, 1.7, 0.13, c.dump());
    EXPECT_LT(at(8).mean, 0.016) << c.dump();
  }
}

}  // namespace
}  // namespace penumbra
