#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "radiosity/enclosure_table.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using test::enclosure_table;

Material lambertian(double reflectance, double emission) {
  Material m;
  m.base_colour = Rgb(static_cast<float>(reflectance));
  m.specular = 0;
  m.emission = Rgb(static_cast<float>(emission / pi));  // so that E is `emission`
  return m;
}

Material mirror(double s) {
  Material m = lambertian(0, 0);
  m.mirror = Rgb(static_cast<float>(s));
  return m;
}

void add_object(Scene& scene, const std::string& name, const std::vector<Polygon>& faces, const Material& material) {
  add_polygons(scene, name, faces, static_cast<std::uint32_t>(scene.materials.size()));
  scene.materials.push_back(material);
}

/// A half, quarter or eighth of a sphere of radius 1, fronts inwards, closed by k mirrors at x = 0, z = 0, y = 0: the
/// images rebuild the sphere. Reflectance is `mean_rho` everywhere, or varies about it with the height; so does the
/// emission about 1. @param n facets from pole to equator.
Scene mirror_octant(int k, double s, double mean_rho, bool patterned, int n) {
  Scene scene;
  const double first = k >= 2 ? 0 : -pi / 2, last = pi / 2;
  const int rings = k == 3 ? n : 2 * n, around = k >= 2 ? n : 2 * n;
  const auto at = [&](int ring, int step) {
    const double polar = pi / 2 * ring / n, angle = first + (last - first) * step / around;
    const double r = std::abs(std::sin(polar)) < 1e-12 ? 0 : std::sin(polar);
    const auto clean = [](double x) { return std::abs(x) < 1e-12 ? 0 : x; };
    return Vec3d(clean(r * std::cos(angle)), clean(std::cos(polar)), clean(r * std::sin(angle)));
  };
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<std::vector<Vec3d>> faces;
    for (int step = 0; step < around; ++step) {
      const Vec3d a = at(ring, step), b = at(ring, step + 1), c = at(ring + 1, step + 1), d = at(ring + 1, step);
      if (a == b) {
        faces.push_back({a, d, c});
      } else if (c == d) {
        faces.push_back({a, d, b});
      } else {
        faces.push_back({a, d, c, b});
      }
      // Inwards.
      auto& f = faces.back();
      const Vec3d normal = cross(f[1] - f[0], f[2] - f[0]);
      if (dot(normal, f[0]) > 0) std::reverse(f.begin(), f.end());
    }
    const double height = std::abs(0.5 * (at(ring, 0).y + at(ring + 1, 0).y));  // its mean over the sphere is 1/2
    const double swing = patterned ? 2 * (height - 0.5) : 0;
    add_object(scene, "ring", faces, lambertian(mean_rho * (1 + 0.1 * swing), 1 - 0.5 * swing));
  }
  const auto add_mirror = [&](std::vector<Vec3d> polygon, const Vec3d& inwards) {
    if (dot(cross(polygon[1] - polygon[0], polygon[2] - polygon[0]), inwards) < 0) {
      std::reverse(polygon.begin(), polygon.end());
    }
    add_object(scene, "mirror", {polygon}, mirror(s));
  };
  std::vector<Vec3d> polygon;
  if (k >= 2) polygon = {Vec3d(0)};
  for (int ring = 0; ring <= rings; ++ring) polygon.push_back(at(ring, around));  // x = 0, z > 0
  if (k == 1) {
    for (int ring = rings - 1; ring > 0; --ring) polygon.push_back(at(ring, 0));
  }
  if (k == 2) polygon.erase(polygon.begin());
  add_mirror(polygon, {1, 0, 0});
  if (k >= 2) {
    polygon.clear();
    if (k == 3) polygon.push_back(Vec3d(0));
    for (int ring = 0; ring <= rings; ++ring) polygon.push_back(at(ring, 0));  // z = 0, x > 0
    add_mirror(polygon, {0, 0, 1});
  }
  if (k == 3) {
    polygon = {Vec3d(0)};
    for (int step = 0; step <= around; ++step) polygon.push_back(at(rings, step));
    add_mirror(polygon, {0, 1, 0});
  }
  return scene;
}

struct Solved {
  std::unique_ptr<RadiositySetup> setup;
  SceneRadiosity result;
};

Solved solve(const Scene& scene, const std::string& solver = "gauss-seidel", int rays = 256) {
  RadiositySetupOptions options;
  options.subdivision = Subdivision::none;
  options.solver = solver;
  options.specular_rays = rays;
  options.factors.tolerance = 1e-4;
  Solved solved;
  solved.setup = make_radiosity_setup(scene, options);
  SolverOptions solving;
  solving.tolerance = 1e-7;
  solving.stop_at = 1;
  solved.result = penumbra::solve(*solved.setup, solving);
  return solved;
}

/// B / (E + rho beta) - 1 over the elements that shine: root mean square and mean over the area.
struct Departure {
  double rms = 0, mean = 0;
};

Departure departure(const Solved& solved, double beta) {
  Departure d;
  double area = 0;
  const RadiosityProblem& p = solved.setup->problem;
  for (std::size_t i = 0; i < p.element_count(); ++i) {
    if (p.emission[3 * i] == 0) continue;
    const double truth = p.emission[3 * i] + p.reflectance[3 * i] * beta;
    const double error = solved.result.solution.radiosity[3 * i] / truth - 1;
    d.rms += p.areas[i] * error * error;
    d.mean += p.areas[i] * error;
    area += p.areas[i];
  }
  d.mean /= area;
  d.rms = std::sqrt(d.rms / area);
  return d;
}

TEST(ExtendedFactors, MirrorsRebuildASphere) {
  for (const auto& c : enclosure_table()["mirror_octant_two_pass"]["cases"]) {
    const int k = c["k"];
    const Solved solved = solve(mirror_octant(k, c["s"], c["mean_rho"], false, 8));
    const Departure d = departure(solved, c["beta"]);
    EXPECT_LE(d.rms, k == 3 ? 0.01 : 0.005) << c;
    EXPECT_NEAR(d.mean, 0, 0.002) << c;  // facets stand for the sphere
  }
}

TEST(ExtendedFactors, MirrorsRebuildAPatternedSphere) {
  const int n = 8;
  for (const int k : {1, 2, 3}) {
    const double s = 0.8;
    const Solved solved = solve(mirror_octant(k, s, 0.7, true, n));
    double emission = 0, reflectance = 0, area = 0;
    const RadiosityProblem& p = solved.setup->problem;
    for (std::size_t i = 0; i < p.element_count(); ++i) {
      if (p.emission[3 * i] == 0) continue;
      emission += p.areas[i] * p.emission[3 * i];
      reflectance += p.areas[i] * p.reflectance[3 * i];
      area += p.areas[i];
    }
    const double m = std::pow((1 + s) / 2, k);
    const double beta = m * (emission / area) / (1 - m * reflectance / area);
    EXPECT_LE(departure(solved, beta).rms, k == 3 ? 0.01 : 0.005) << k;
    EXPECT_LE(std::abs(departure(solved, beta).mean), std::max(0.002, 3 * solved.result.specular_error)) << k;
  }
}

TEST(ExtendedFactors, EverySolverFindsTheSame) {
  const Scene scene = mirror_octant(2, 0.8, 0.6, true, 4);
  const Solved first = solve(scene);
  for (const char* name : {"direct", "jacobi", "shooting", "progressive"}) {
    const Solved other = solve(scene, name);
    for (std::size_t k = 0; k < first.result.solution.radiosity.size(); ++k) {
      ASSERT_NEAR(other.result.solution.radiosity[k], first.result.solution.radiosity[k], 1e-5) << name;
    }
  }
}

TEST(ExtendedFactors, EnergyCloses) {
  for (const char* name : {"gauss-seidel", "shooting"}) {
    const EnergyBalance energy = solve(mirror_octant(3, 0.5, 0.6, false, 6), name).result.solution.energy;
    EXPECT_NEAR(energy.absorbed + energy.escaped, energy.emitted, 1e-5 * energy.emitted) << name;
    EXPECT_NEAR(energy.escaped, 0, 1e-4 * energy.emitted) << name;
  }
}

// A square that shines and a mirror over it: what the mirror does not send back leaves the scene.
TEST(ExtendedFactors, LightThatMirrorsSendAwayEscapes) {
  Scene scene;
  const std::vector<Vec3d> square{{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}};
  std::vector<Vec3d> above;
  for (auto corner = square.rbegin(); corner != square.rend(); ++corner) above.push_back(*corner + Vec3d(0, 1, 0));
  add_object(scene, "lamp", {square}, lambertian(0, 1));
  add_object(scene, "mirror", {above}, mirror(1));
  const Solved solved = solve(scene, "gauss-seidel", 4096);
  const EnergyBalance& energy = solved.result.solution.energy;
  // By images: the lamp sees its own image 2 m away; of what the mirror gets the rest passes by the lamp.
  const double to_mirror = 0.4152533;  // two squares of edge 2 at distance 1: X = Y = 2 (catalogue C-11)
  const double to_image = 0.1998249;   // at distance 2: X = Y = 1
  // Through the mirror the lamp sees exactly its image as far as the mirror reaches: the whole of it.
  const double area = 4, emitted = energy.emitted;
  EXPECT_NEAR(emitted, 3 * area, 1e-6);
  EXPECT_NEAR(energy.absorbed, to_image * emitted, 0.01 * emitted);
  EXPECT_NEAR(energy.escaped, (1 - to_image) * emitted, 0.01 * emitted);
  EXPECT_NEAR(solved.setup->problem.specular->leaving[0], to_mirror - to_image, 0.01);
}

// A lamp without body over a mirror: its image lights the ceiling.
TEST(ExtendedFactors, LightWithoutABodyIsMirrored) {
  Scene scene;
  const auto square = [](double y, double half, bool up) {
    std::vector<Vec3d> corners{{-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}};
    if (!up) std::reverse(corners.begin(), corners.end());
    return corners;
  };
  add_object(scene, "mirror", {square(0, 4, true)}, mirror(0.5));
  add_object(scene, "ceiling", {square(2, 0.1, false)}, lambertian(0, 0));
  scene.lights.push_back({"point", PointLight{.position = {0, 1, 0}, .intensity = {4, 2, 0}}});
  const Solved solved = solve(scene, "gauss-seidel", 200000);
  const std::vector<double>& irradiance = solved.result.solution.irradiance;
  std::size_t ceiling = 0;
  for (std::size_t i = 0; i < solved.setup->mesh.surface_count(); ++i) {
    if (solved.setup->mesh.normals[i].y < 0 && solved.setup->mesh.centroids[i].y > 1) ceiling = i;
  }
  // I / d^2 straight, and half of I / (3 d)^2 by the image.
  EXPECT_NEAR(irradiance[3 * ceiling], 4 * (1 + 0.5 / 9), 0.05);
  EXPECT_NEAR(solved.setup->problem.specular_irradiance[3 * ceiling], 4 * 0.5 / 9, 0.02);
  EXPECT_NEAR(solved.setup->problem.specular_irradiance[3 * ceiling + 1], 2 * 0.5 / 9, 0.01);
  EXPECT_EQ(irradiance[3 * ceiling + 2], 0);
}

// Light that a pane of glass lets pass reaches the floor: by the plate's transmittance.
TEST(ExtendedFactors, APaneLetsLightPass) {
  Scene scene;
  const auto square = [](double y, double half, bool up) {
    std::vector<Vec3d> corners{{-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}};
    if (!up) std::reverse(corners.begin(), corners.end());
    return corners;
  };
  Material pane = lambertian(1, 0);
  pane.specular = 1;
  pane.roughness = 0;
  pane.transmission = 1;
  pane.thin_walled = true;
  pane.ior = 1.5F;
  add_object(scene, "lamp", {square(1, 0.05, false)}, lambertian(0, pi * 100));
  add_object(scene, "pane", {square(0.5, 2, true)}, pane);
  add_object(scene, "floor", {square(0, 0.05, true)}, lambertian(0.5, 0));
  const Solved solved = solve(scene, "gauss-seidel", 400000);
  std::size_t floor = 0;
  for (std::size_t i = 0; i < solved.setup->mesh.surface_count(); ++i) {
    if (solved.setup->mesh.normals[i].y > 0 && solved.setup->mesh.centroids[i].y == 0) floor = i;
  }
  // Nearly normal incidence: (1 - R) / (1 + R) = 12/13 of L A / d^2.
  EXPECT_NEAR(solved.result.solution.irradiance[3 * floor], 12.0 / 13 * 100 * 0.01, 0.03);
}

TEST(ExtendedFactors, ThreadedTheSameBits) {
  const Scene scene = mirror_octant(2, 0.8, 0.6, true, 4);
  std::vector<double> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const Solved solved = solve(scene, "gauss-seidel", 64);
    if (first.empty()) first = solved.result.solution.radiosity;
    EXPECT_EQ(solved.result.solution.radiosity, first) << threads;
  }
}

}  // namespace
}  // namespace penumbra
