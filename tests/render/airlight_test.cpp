// Light in participating media against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/distance_sampling.h"
#include "penumbra/render/render.h"
#include "render/probe.h"
#include "test_paths.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using testing::look;
using testing::matt;
using testing::path;
using testing::Seen;
using testing::whitted;

nlohmann::json media_cases(const char* section, const char* table) {
  nlohmann::json found =
      nlohmann::json::parse(std::ifstream(PENUMBRA_TEST_DATA "/participating_media.json")).at(section).at(table);
  EXPECT_FALSE(found.empty());
  return found;
}

Medium medium(double absorption, double scattering, double g = 0) {
  return {.name = "medium",
          .absorption = Rgb(static_cast<float>(absorption)),
          .scattering = Rgb(static_cast<float>(scattering)),
          .asymmetry = static_cast<float>(g)};
}

/// A closed box of a medium whose walls are not seen.
void add_hidden_box(Scene& scene, const Medium& m, const Vec3d& lower, const Vec3d& upper) {
  Material wall = matt(Rgb(0));
  wall.alpha_mode = AlphaMode::blend;
  wall.alpha = 0;
  wall.medium = static_cast<std::uint32_t>(scene.media.size());
  scene.media.push_back(m);
  testing::add_mesh(scene, testing::box(lower, upper), wall);
}

void add_sun(Scene& scene, const Vec3d& towards) {
  scene.lights.push_back(
      {.name = "sun", .kind = DirectionalLight{.direction = normalize(towards), .irradiance = Rgb(1)}});
}

RenderOptions single_scattering_by_path(int samples) {
  RenderOptions options = path(samples);
  options.max_depth = 1;
  return options;
}

void expect_seen(const Seen& seen, double truth, double relative_error_at_most, const std::string& what) {
  EXPECT_NEAR(seen.value, truth, 3 * seen.error + 1e-4 * truth) << what;
  EXPECT_LT(seen.error, relative_error_at_most * truth) << what;
}

TEST(DistanceSampling, DensitiesAreThoseOfTheirSamples) {
  const Ray ray{.origin = {0, 0, 0}, .direction = {0, 0, 1}, .t_min = 0, .t_max = 10};
  const auto check = [](const auto& distances, double from, double to) {
    // The inverse of the distribution has the slope 1 / density.
    for (const double u : {0.01, 0.2, 0.5, 0.77, 0.99}) {
      const double h = 1e-6;
      const double slope = (distances.sample(u + h) - distances.sample(u - h)) / (2 * h);
      EXPECT_NEAR(slope * distances.pdf(distances.sample(u)), 1, 1e-5) << u;
    }
    EXPECT_NEAR(distances.sample(0), from, 1e-9);
    EXPECT_NEAR(distances.sample(1), to, 1e-9);
  };
  check(EquiangularDistances(ray, {0.5, 0, 4}, {1, 8}), 1, 8);
  check(EquiangularDistances(ray, {0.5, 0, -4}, {1, 8}), 1, 8);
  check(ExponentialDistances(0.7, {1, 8}), 1, 8);
  check(ExponentialDistances(0, {1, 8}), 1, 8);
}

// A lamp in fog, beside the ray (Sun, Ramamoorthi, Narasimhan & Nayar 2005).
TEST(Airlight, PointSource) {
  for (const auto& c : media_cases("airlight_point_source", "table")) {
    const double sigma = c["sigma_t"], distance = c["D"], gamma = c["gamma_deg"].get<double>() * pi / 180;
    Scene scene;
    testing::add_plane(scene, {0, 0, c["T_surface"]}, {0, 0, -1}, matt(Rgb(0)));
    scene.lights.push_back(
        {.name = "lamp",
         .kind = PointLight{.position = distance * Vec3d(std::sin(gamma), 0, std::cos(gamma)), .intensity = Rgb(1)}});
    scene.media = {medium(0, sigma)};
    scene.air = {0};
    const RayTracer tracer(scene);
    const double truth = c["L_airlight"];
    expect_seen(look(tracer, {0, 0, 0}, {0, 0, 1}, whitted(4096)), truth, 4e-3, "whitted");
    expect_seen(look(tracer, {0, 0, 0}, {0, 0, 1}, single_scattering_by_path(16384)), truth, 1e-2, "path");
  }
}

// A beam from the side into a pencil of fog too thin to weaken it.
TEST(Airlight, CollimatedBeam) {
  for (const auto& c : media_cases("airlight_collimated", "cases")) {
    const double scattering = c["sigma_s"], extinction = c["sigma_t"], s = c["s"];
    Scene scene;
    add_hidden_box(scene, medium(extinction - scattering, scattering), {-1e-5, -1e-5, 0}, {1e-5, 1e-5, s});
    add_sun(scene, {0, -1, 0});
    const RayTracer tracer(scene);
    expect_seen(look(tracer, {1e-6, 2e-6, -1}, {0, 0, 1}, whitted(1024)), c["L"], 1e-4, "whitted");
    expect_seen(look(tracer, {1e-6, 2e-6, -1}, {0, 0, 1}, path(16384)), c["L"], 2e-2, "path");
  }
}

// Light from everywhere, scattered once: albedo L0 (1 - exp(-sigma s)).
TEST(Airlight, AmbientLight) {
  Scene scene;
  testing::add_plane(scene, {0, 0, 3}, {0, 0, -1}, matt(Rgb(0)));
  scene.lights.push_back({.name = "ambient", .kind = AmbientLight{Rgb(2)}});
  scene.media = {medium(0.2, 0.3)};
  scene.air = {0};
  const RayTracer tracer(scene);
  const double truth = 0.6 * 2 * (1 - std::exp(-1.5));
  EXPECT_NEAR(look(tracer, {0, 0, 0}, {0, 0, 1}, whitted(1)).value, truth, 1e-5 * truth);
}

TEST(Airlight, SinglyScatteringSlab) {
  for (const auto& c : media_cases("slab_single_scatter", "table")) {
    const double tau = c["tau"], mu0 = c["mu0"], mu = c["mu"];
    Scene scene;
    add_hidden_box(scene, medium(0, tau), {-500, -500, 0}, {500, 500, 1});
    add_sun(scene, {std::sqrt(1 - mu0 * mu0), 0, mu0});  // into the face z = 0
    const RayTracer tracer(scene);
    const Vec3d away(0, std::sqrt(1 - mu * mu), -mu);
    const Vec3d through(0, std::sqrt(1 - mu * mu), mu);
    const double reflected = c["L_reflected_per_unit_normal_irradiance"], transmitted = c["L_transmitted"];
    expect_seen(look(tracer, 2.0 * away, -away, whitted(1024)), reflected, 1e-2, "reflected, whitted");
    expect_seen(look(tracer, 3.0 * through, -through, whitted(1024)), transmitted, 0.2, "transmitted, whitted");
    expect_seen(look(tracer, 2.0 * away, -away, single_scattering_by_path(16384)), reflected, 3e-2, "reflected, path");
  }
}

// Chandrasekhar's half-space: seen from above under a beam from above, and, by reciprocity, its albedo for a beam as
// its radiance under an even sky.
void expect_half_space(int beam_samples, int sky_samples, double relative_error_at_most) {
  for (const auto& c : media_cases("halfspace_isotropic_multiple_scatter", "table")) {
    const double albedo = c["albedo"];
    Scene scene;
    add_hidden_box(scene, medium(1 - albedo, albedo), {-80, -80, -60}, {80, 80, 0});
    Scene under_sky = scene;
    add_sun(scene, {0, 0, -1});
    const RayTracer tracer(scene);
    expect_seen(look(tracer, {0.1, 0.2, 1}, {0, 0, -1}, path(beam_samples)),
                c["bidirectional_L_mu1_mu0_1_per_unit_flux"], relative_error_at_most, "beam");
    under_sky.environment = Environment{};
    const RayTracer sky_tracer(under_sky);
    for (const auto& [cosine, plane_albedo] : c["plane_albedo"].items()) {
      const double mu = std::stod(cosine);
      const Vec3d away(std::sqrt(1 - mu * mu), 0, mu);
      expect_seen(look(sky_tracer, away, -away, path(sky_samples)), plane_albedo, relative_error_at_most,
                  "albedo at " + cosine);
    }
  }
}

TEST(Airlight, HalfSpaceScattersManyTimes) { expect_half_space(8192, 4096, 5e-2); }

TEST(Airlight, SlowHalfSpaceScattersManyTimes) { expect_half_space(1 << 18, 1 << 17, 1e-2); }

// A white furnace: media that absorb nothing change nothing in a world of one radiance, whatever their phase function.
TEST(Airlight, FurnaceOfScatteringSmoke) {
  Scene scene;
  scene.environment = Environment{};
  Medium smoke = medium(0, 2, 0.7);
  smoke.scattering = Rgb(1, 2, 4);
  std::vector<float> density;
  for (int i = 0; i < 60; ++i) density.push_back(static_cast<float>(i % 7) / 6);
  smoke.density = DensityGrid{.cells = {3, 4, 5}, .values = density, .box = {{-1, -1, -1}, {1, 1, 1}}};
  scene.media = {smoke};
  scene.air = {0};
  testing::add_shape(scene, Sphere{{0, 0, 0}, 0.3}, matt(Rgb(1)));
  const RayTracer tracer(scene);
  const Seen seen = look(tracer, {0.1, 0.2, -4}, {0, 0, 1}, path(4096));
  for (int band = 0; band < 3; ++band) EXPECT_NEAR(seen.radiance[band], 1, 4 * seen.error + 1e-3);
  EXPECT_LT(seen.error, 0.02);
}

// Both integrators agree on single scattering where a blocker's shadow stands in the fog.
TEST(Airlight, ShadowsInFogAreTheSameForBothIntegrators) {
  Scene scene;
  testing::add_plane(scene, {0, 0, 6}, {0, 0, -1}, matt(Rgb(0)));
  testing::add_shape(scene, Sphere{{1, 0, 3}, 0.5}, matt(Rgb(0)));
  scene.lights.push_back({.name = "lamp",
                          .kind = SpotLight{.position = {4, 0, 3},
                                            .direction = {-1, 0, 0},
                                            .intensity = Rgb(5),
                                            .inner_angle = 0.2,
                                            .outer_angle = 0.6}});
  scene.media = {medium(0.05, 0.2, 0.5)};
  scene.air = {0};
  const RayTracer tracer(scene);
  const Seen a = look(tracer, {0, 0, 0}, {0, 0, 1}, whitted(1024));
  const Seen b = look(tracer, {0, 0, 0}, {0, 0, 1}, single_scattering_by_path(4096));
  EXPECT_NEAR(a.value, b.value, 3 * (a.error + b.error));
  EXPECT_LT(a.error, 0.02 * a.value);
  // The blocker matters.
  Scene open = scene;
  open.shapes.pop_back();
  const RayTracer clear(open);
  EXPECT_GT(look(clear, {0, 0, 0}, {0, 0, 1}, whitted(1024)).value, 1.1 * a.value);
}

TEST(Airlight, MethodsThatKnowNoMediaRefuseThem) {
  Scene scene;
  testing::add_plane(scene, {0, 0, 6}, {0, 0, -1}, matt(Rgb(0)));
  scene.media = {medium(0, 1)};
  scene.air = {0};
  const RayTracer tracer(scene);
  for (const IntegratorKind kind : {IntegratorKind::appel, IntegratorKind::light}) {
    RenderOptions options = whitted(1);
    options.integrator = kind;
    EXPECT_THROW((void)look(tracer, {0, 0, 0}, {0, 0, 1}, options), std::invalid_argument);
  }
}

TEST(Airlight, ThreadedPicturesOfMediaAreTheSame) {
  Scene scene;
  testing::add_plane(scene, {0, -1, 0}, {0, 1, 0}, matt(Rgb(0.5F)));
  scene.lights.push_back({.name = "lamp", .kind = PointLight{.position = {0, 2, 3}, .intensity = Rgb(5)}});
  Medium smoke = medium(0.5, 2);
  smoke.density = DensityGrid{.cells = {2, 2, 2}, .values = {0, 1, 2, 3, 1, 0, 2, 1}, .box = {{-1, -1, 2}, {1, 1, 4}}};
  scene.media = {medium(0, 0.1), smoke};
  scene.air = {0, 1};
  const RayTracer tracer(scene);
  const Camera camera{
      .name = "", .to_world = look_at(Vec3d(0, 0, -1), Vec3d(0, 0, 3), Vec3d(0, 1, 0)), .lens = PerspectiveLens{}};
  for (RenderOptions options : {whitted(1), path(2)}) {
    options.width = 48;
    options.height = 36;
    std::vector<float> first;
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      const auto picture = render(tracer, camera, options).image.data;
      if (first.empty()) first = picture;
      EXPECT_EQ(picture, first) << threads;
    }
  }
}

}  // namespace
}  // namespace penumbra
