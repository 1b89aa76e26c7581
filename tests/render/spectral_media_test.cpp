// Wavelengths in fog, smoke and coloured media: each has a coefficient of its own, and closed forms of its own.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "penumbra/math/cie_colour.h"
#include "penumbra/math/uplift.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/render.h"
#include "penumbra/scene/builtin_scenes.h"
#include "render/spectral_truth.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

const Rgb red_light{0.1F, 0.5F, 1.4F};  // a coefficient that lets red pass

Medium medium(const Rgb& absorption, const Rgb& scattering, float g = 0) {
  return {.name = "medium", .absorption = absorption, .scattering = scattering, .asymmetry = g};
}

void fill_air(Scene& scene, Medium m) {
  scene.air = {static_cast<std::uint32_t>(scene.media.size())};
  scene.media.push_back(std::move(m));
}

/// What is left of white light after an optical depth of `length` (m) times the coefficient, by wavelength.
Vec3d weakened(const Rgb& coefficient, double length) {
  return over_wavelengths([&](const Bands& bands) {
    return bands.emission(Rgb(1)) * glm::exp(-static_cast<float>(length) * bands.reflectance(coefficient));
  });
}

// Beer-Lambert is no product of three numbers once the coefficient is a spectrum.
TEST(SpectralMedia, AWhiteWallThroughColouredAir) {
  Scene scene;
  add_plane(scene, {0, 0, 2}, {0, 0, -1}, glow(Rgb(1)));
  fill_air(scene, medium(red_light, Rgb(0)));
  const RayTracer tracer(scene);
  const Vec3d truth = weakened(red_light, 2);
  for (const RenderOptions& options : {spectral(path(1024)), spectral(whitted(1024))}) {
    expect_colour(look(tracer, {0, 0, 0}, {0, 0, 1}, options), truth, 0.02);
  }
  const Rgb in_rgb = look(tracer, {0, 0, 0}, {0, 0, 1}, path(1)).radiance;
  EXPECT_GT(std::abs(truth.z - in_rgb.z), 0.02 * in_rgb.z) << "RGB and wavelengths rightly differ";
}

// Densities of a grid multiply the coefficient: a wedge that grows from 0 to 3 over its middle cells.
TEST(SpectralMedia, AWhiteWallThroughAGridOfColouredSmoke) {
  Scene scene;
  add_plane(scene, {0, 0, 4}, {0, 0, -1}, glow(Rgb(1)));
  Medium smoke = medium(red_light, Rgb(0));
  smoke.density = DensityGrid{.cells = {1, 1, 2}, .values = {0, 3}, .box = {{-1, -1, 1}, {1, 1, 3}}};
  fill_air(scene, smoke);
  const RayTracer tracer(scene);
  // Half a metre of 0, a metre from 0 to 3, half a metre of 3.
  const Vec3d truth = weakened(red_light, 1.5 + 1.5);
  for (const RenderOptions& options : {spectral(path(1024)), spectral(whitted(1024))}) {
    expect_colour(look(tracer, {0, 0, 0}, {0, 0, 1}, options), truth, 0.02);
  }
}

/// Single scattering of a point lamp's light along a ray from the origin along z, integrated by the midpoint rule
/// (Sun, Ramamoorthi, Narasimhan & Nayar 2005 give it as a table).
double airlight(double sigma_s, double sigma_t, const Vec3d& lamp, double length) {
  constexpr int steps = 1000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps * length;
    const double d2 = lamp.x * lamp.x + lamp.y * lamp.y + (lamp.z - t) * (lamp.z - t);
    sum += sigma_s / (4 * pi) * std::exp(-sigma_t * (t + std::sqrt(d2))) / d2 * length / steps;
  }
  return sum;
}

TEST(SpectralMedia, ALampInColouredFog) {
  Scene scene;
  const Vec3d lamp(1, 0, 2);
  add_plane(scene, {0, 0, 4}, {0, 0, -1}, matt(Rgb(0)));
  scene.lights.push_back({.name = "lamp", .kind = PointLight{.position = lamp, .intensity = Rgb(1)}});
  const Rgb absorption(0.1F, 0.05F, 0.02F), scattering(0.05F, 0.2F, 0.6F);
  fill_air(scene, medium(absorption, scattering));
  const RayTracer tracer(scene);
  // By spectral coefficient, in a table: it is smooth.
  const Vec3d truth = [&] {
    Vec3d sum(0);
    constexpr int samples = 400;
    for (int i = 0; i < samples; ++i) {
      const Bands bands = Bands::sample((i + 0.5) / samples);
      Rgb light = bands.emission(Rgb(1));
      for (int k = 0; k < 3; ++k) {
        const double s = bands.reflectance(scattering)[k], a = bands.reflectance(absorption)[k];
        light[k] *= static_cast<float>(airlight(s, s + a, lamp, 4));
      }
      sum += Vec3d(bands.to_rgb(light)) / double{samples};
    }
    return sum;
  }();
  expect_colour(look(tracer, {0, 0, 0}, {0, 0, 1}, spectral(whitted(4096))), truth, 0.02, "whitted");
  RenderOptions once = spectral(path(16384));
  once.max_depth = 1;
  expect_colour(look(tracer, {0, 0, 0}, {0, 0, 1}, once), truth, 0.03, "path");
}

// A white furnace: coloured smoke that absorbs nothing changes nothing in a white world.
TEST(SpectralMedia, FurnaceOfColouredSmoke) {
  Scene scene;
  scene.environment = Environment{};
  Medium smoke = medium(Rgb(0), {1, 2, 4}, 0.6F);
  std::vector<float> density;
  for (int i = 0; i < 60; ++i) density.push_back(static_cast<float>(i % 7) / 6);
  smoke.density = DensityGrid{.cells = {3, 4, 5}, .values = density, .box = {{-1, -1, -1}, {1, 1, 1}}};
  fill_air(scene, smoke);
  add_shape(scene, Sphere{{0, 0, 0}, 0.3}, matt(Rgb(1)));
  const RayTracer tracer(scene);
  expect_colour(look(tracer, {0.1, 0.2, -4}, {0, 0, 1}, spectral(path(4096))), Vec3d(1), 0.03);
}

// A dye in fog: the light that excites it is weakened at its own wavelengths, what it radiates at others.
TEST(SpectralMedia, ADyeSeenThroughColouredAir) {
  Scene scene;
  const std::vector<double> edges{400, 440, 520, 620};
  Material paint = matt(Rgb(0));
  paint.fluorescence = Fluorescence{edges, {0, 0, 0, 0.3, 0, 0, 0.4, 0, 0}};
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, paint);
  Material lamp = glow(Rgb(0));
  lamp.emission_spectrum = EmissionSpectrum{{400, 440}, {5}};
  lamp.emission = lamp.emission_spectrum->colour();
  add_shape(scene, Disk{{0, 2, 0}, {0, -1, 0}, 0.01}, lamp);
  const Rgb coefficient(0.1F, 0.4F, 0.8F);
  fill_air(scene, medium(coefficient, Rgb(0)));
  const RayTracer tracer(scene);
  const double irradiance = pi * 5 * 1e-4 / (4 + 1e-4);
  // Each band of the dye even over its width; the coefficient's mean over the violet band, where it is nearly flat.
  const double violet = [&] {
    double passed = 0;
    for (int i = 0; i < 400; ++i) {
      passed += std::exp(-2 * dot(Vec3d(coefficient), uplift_basis(400 + (i + 0.5) / 10))) / 400;
    }
    return passed;
  }();
  Vec3d truth(0);
  for (int band = 1; band < 3; ++band) {
    const double width = edges[static_cast<std::size_t>(band) + 1] - edges[static_cast<std::size_t>(band)];
    const double share = band == 1 ? 0.3 : 0.4;
    for (int i = 0; i < 1000; ++i) {
      const double nm = edges[static_cast<std::size_t>(band)] + (i + 0.5) / 1000 * width;
      truth += share * irradiance / pi * violet * std::exp(-dot(Vec3d(coefficient), uplift_basis(nm))) *
               rec709_matching(nm) / 1000.0;
    }
  }
  RenderOptions options = spectral(whitted(8192));
  options.max_depth = 1;
  const Vec3d away = normalize(Vec3d(0.3, 1, 0));
  expect_colour(look(tracer, away, -away, options), truth, 0.03);
}

TEST(SpectralMedia, ThreadedPicturesAreTheSameOnAnyNumberOfThreads) {
  for (const char* name : {"fog", "smoke?cells=12"}) {
    Scene scene = make_builtin_scene(name);
    scene.media[0].scattering *= Rgb(0.5F, 0.8F, 1.2F);
    const RayTracer tracer(scene);
    for (RenderOptions options : {spectral(path(2)), spectral(whitted(1))}) {
      options.width = 40;
      options.height = 24;
      options.max_depth = 6;
      std::vector<std::vector<float>> pictures;
      for (const int threads : {1, 2, 8}) {
        const ThreadLimit limit(threads);
        pictures.push_back(render(tracer, scene.cameras[0], options).image.data);
      }
      EXPECT_EQ(pictures[0], pictures[1]) << name;
      EXPECT_EQ(pictures[0], pictures[2]) << name;
    }
  }
}

}  // namespace
}  // namespace penumbra
