// Light with wavelengths: what RGB and spectral pictures share, and what only wavelengths can do.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "penumbra/math/cie_colour.h"
#include "penumbra/math/dispersion.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/specular_tree.h"
#include "render/spectral_truth.h"
#include "test_paths.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;
constexpr double degree = pi / 180;

nlohmann::json optics() { return nlohmann::json::parse(std::ifstream(PENUMBRA_TEST_DATA "/optics_spectrum.json")); }

/// A room from inside: a cube of two metres about the origin.
Scene room(const Material& material) {
  Scene scene = make_builtin_scene("furnace");
  scene.materials[0] = material;
  return scene;
}

// Round trip

TEST(Spectral, DirectlyLitSurfacesLookAsInRgb) {
  Scene scene;
  scene.environment = Environment{.radiance = Rgb(1), .image = {}};
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, matt({0.63F, 0.065F, 0.05F}));
  const RayTracer tracer(scene);
  for (const RenderOptions& options : {path(1024), whitted(1024)}) {
    const Rgb truth = look(tracer, {0, 1, 0}, {0, -1, 0}, options).radiance;
    const Rgb seen = look(tracer, {0, 1, 0}, {0, -1, 0}, spectral(options)).radiance;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], truth[k], 1e-3) << k;
  }
}

TEST(Spectral, LampsSkiesMirrorsAndGlassKeepTheirColours) {
  Scene scene;
  scene.environment = Environment{.radiance = {0.2F, 0.5F, 3.0F}, .image = {}};
  add_plane(scene, {0, -1, 0}, {0, 1, 0}, mirror({0.9F, 0.5F, 0.2F}));
  Material lamp = glow({17, 12, 4});
  add_shape(scene, Sphere{{5, 0, 0}, 1}, lamp);
  Material tinted = glass(1);
  tinted.base_colour = {0.3F, 0.9F, 0.6F};
  tinted.thin_walled = true;
  add_shape(scene, Sphere{{-5, 0, 0}, 1}, tinted);
  const RayTracer tracer(scene);
  for (const Vec3d& way : {Vec3d(0, 1, 0), Vec3d(1, 0, 0), Vec3d(-1, 0, 0)}) {
    for (const RenderOptions& options : {path(4096), whitted(4096)}) {
      const Rgb truth = look(tracer, {0, 0, 0}, way, options).radiance;
      const Rgb seen = look(tracer, {0, 0, 0}, way, spectral(options)).radiance;
      const float scale = max_component(truth);
      // The sky seen through two tints is no product of numbers.
      const float tolerance = way.x < 0 ? 0.2F : 1e-3F;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k] / scale, truth[k] / scale, tolerance) << way.x << way.y << k;
    }
  }
}

// In a closed grey room that reflects half and emits white, radiance is 2 in RGB and in wavelengths alike.
TEST(Spectral, AGreyFurnaceIsGrey) {
  const Scene scene = make_builtin_scene("furnace?rho=0.5&emission=1");
  const RayTracer tracer(scene);
  expect_colour(look(tracer, {-0.7, 0.3, 0.8}, {0.9, -0.5, -1}, spectral(path(4096))), Vec3d(2), 0.02);
}

TEST(Spectral, InterreflectionOfAColourDiffersFromRgb) {
  Material red = matt({0.9F, 0.3F, 0.3F});
  red.emission = Rgb(1);
  const Scene scene = room(red);
  const RayTracer tracer(scene);
  const Rgb rgb = look(tracer, {-0.7, 0.3, 0.8}, {0.9, -0.5, -1}, path(4096)).radiance;
  const Seen seen = look(tracer, {-0.7, 0.3, 0.8}, {0.9, -0.5, -1}, spectral(path(16384)));
  EXPECT_GT(std::abs(seen.radiance.x - rgb.x) / rgb.x, 0.02F);
  // Truth: each wavelength by itself has radiance white / (1 - reflectance).
  const Vec3d truth =
      over_wavelengths([&](const Bands& b) { return b.emission(Rgb(1)) / (Rgb(1) - b.reflectance(red.base_colour)); });
  expect_colour(seen, truth, 0.02);
}

TEST(Spectral, OtherIntegratorsRefuseIt) {
  const Scene scene = make_builtin_scene("furnace");
  const RayTracer tracer(scene);
  RenderOptions options = spectral(whitted());
  options.integrator = IntegratorKind::appel;
  EXPECT_THROW((void)render(tracer, scene.cameras[0], options), std::invalid_argument);
}

TEST(Spectral, ThreadedPicturesAreTheSameOnAnyNumberOfThreads) {
  for (const char* name : {"prism", "fluorescent"}) {
    const Scene scene = make_builtin_scene(name);
    const RayTracer tracer(scene);
    for (RenderOptions options : {spectral(path(2)), spectral(whitted(2))}) {
      options.width = 48;
      options.height = 36;
      options.max_depth = 8;
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

// Dispersion

/// The direction of a ray of one wavelength once it has left all glass, refracted wherever it can be, after `mirrored`
/// reflections inside. Traced through the scene's own surfaces and BSDFs, as Whitted's recursion does.
Vec3d through_glass(const RayTracer& tracer, Ray ray, double index, int mirrored) {
  for (int k = 0; k < 16; ++k) {
    const auto hit = tracer.nearest(ray);
    if (!hit) return ray.direction;
    const SurfacePoint point = tracer.surface_point(ray, *hit);
    SurfaceMaterial surface = surface_material(tracer.scene(), point);
    surface.ior = static_cast<float>(index);
    const Bsdf bsdf(surface, Frame(point.shading_normal), point.geometric_normal);
    const SpecularSplit split = bsdf.specular_split(-ray.direction, 0.1);
    const bool inside = dot(point.geometric_normal, ray.direction) > 0;
    const bool reflects = inside && mirrored-- > 0;
    if (!reflects && is_black(split.refracted)) return Vec3d(0);
    ray = leave(point, reflects ? split.reflection_direction : split.refraction_direction);
  }
  return Vec3d(0);
}

/// The smallest value of f near x0, by golden section.
template <class Function>
double least(double lower, double upper, const Function& f) {
  const double g = (std::sqrt(5.0) - 1) / 2;
  for (int k = 0; k < 60; ++k) {
    const double a = upper - g * (upper - lower), b = lower + g * (upper - lower);
    f(a) < f(b) ? upper = b : lower = a;
  }
  return f((lower + upper) / 2);
}

TEST(Dispersion, APrismOf60DegreesDeviatesAsTheCatalogueSays) {
  const Scene scene = make_builtin_scene("prism");
  Scene prism = scene;  // alone: the lamp and the table end no ray
  std::erase_if(prism.instances, [](const Instance& i) { return i.name != "prism"; });
  const RayTracer tracer(prism);
  const auto table = optics()["sellmeier"];
  for (const auto& [name, glass] : table["glasses"].items()) {
    const Dispersion dispersion =
        Sellmeier{glass["B"].get<std::array<double, 3>>(), glass["C_um2"].get<std::array<double, 3>>()};
    for (const auto& [line, truth] : glass["prism60_min_deviation_deg"].items()) {
      const double n = refractive_index(dispersion, 1000 * table["lines_um"][line].get<double>());
      const auto deviation = [&](double turn) {
        const Vec3d way(-std::sin(turn), 0, std::cos(turn));
        const Vec3d aim(-0.01, 0.08, 0);  // halfway up the two faces that the ray crosses
        const Vec3d out = through_glass(tracer, {.origin = aim - 0.5 * way, .direction = way}, n, 0);
        return out == Vec3d(0) ? 180.0 : std::acos(std::clamp(dot(way, out), -1.0, 1.0)) / degree;
      };
      const double half = truth.get<double>() / 2 * degree;
      EXPECT_NEAR(least(half - 0.1, half + 0.1, deviation), truth.get<double>(), 1e-4 * truth.get<double>())
          << name << " " << line;
    }
  }
}

// Descartes 1637: where the deviation by a sphere of water is least, light is brightest.
TEST(Dispersion, RainbowAngles) {
  Scene scene;
  add_shape(scene, Sphere{{0, 0, 0}, 1}, glass(1.33F));
  const RayTracer tracer(scene);
  const auto table = optics()["rainbow"]["table"];
  ASSERT_FALSE(table.empty());
  for (const auto& row : table) {
    const double n = row["n"].get<double>();
    // Angle between the way to the sun and the way back to it: the largest of one reflection, the least of two.
    const auto angle = [&](double height, int mirrored) {
      const Vec3d out = through_glass(tracer, {.origin = {height, 0, -3}, .direction = {0, 0, 1}}, n, mirrored);
      return std::acos(std::clamp(-out.z, -1.0, 1.0)) / degree;
    };
    const double primary = -least(0.6, 0.99, [&](double h) { return -angle(h, 1); });
    const double secondary = least(0.85, 0.999, [&](double h) { return angle(h, 2); });
    EXPECT_NEAR(primary, row["primary_deg"].get<double>(), 1e-4 * primary);
    EXPECT_NEAR(secondary, row["secondary_deg"].get<double>(), 1e-4 * secondary);
  }
}

/// White light from a narrow strip, seen through a prism: `path` and `whitted` send each wavelength its own way, and
/// find the same colours.
TEST(Dispersion, PathAndWhittedSeeTheSameSpectrum) {
  Scene scene = make_builtin_scene("prism");
  scene.environment.reset();
  scene.materials[0] = matt(Rgb(0));  // the table: whitted's shadow rays pass glass straight
  const RayTracer tracer(scene);
  const Vec3d eye = Vec3d(scene.cameras[0].to_world[3]);
  double colourful = 0;
  for (const double across : {-0.055, -0.045, -0.035}) {
    const Vec3d way = Vec3d(across, 0.12, 0.0375 + across / std::sqrt(3.0)) - eye;
    const Rgb by_path = look(tracer, eye, way, spectral(path(2048))).radiance;
    const Rgb by_whitted = look(tracer, eye, way, spectral(whitted(1024))).radiance;
    const float scale = std::max(1.0F, max_component(by_whitted));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(by_path[k] / scale, by_whitted[k] / scale, 0.08F) << across << " " << k;
    colourful = std::max<double>(colourful, std::abs(by_whitted.x - by_whitted.z));
  }
  EXPECT_GT(colourful, 0.5);
}

// The same without wavelengths is white or black: no colour arises.
TEST(Dispersion, RgbSeesNone) {
  Scene scene = make_builtin_scene("prism");
  scene.environment.reset();
  const RayTracer tracer(scene);
  const Vec3d eye = Vec3d(scene.cameras[0].to_world[3]);
  scene.materials[0] = matt(Rgb(0));  // the table
  float brightest = 0;
  for (int k = -20; k <= 20; ++k) {
    const double across = 0.001 * k;
    const Rgb seen = look(tracer, eye, Vec3d(across, 0.12, 0.0375 + across / std::sqrt(3.0)) - eye, whitted()).radiance;
    EXPECT_FLOAT_EQ(seen.x, seen.z);
    brightest = std::max(brightest, seen.x);
  }
  EXPECT_GT(brightest, 10) << "the lamp is seen";
}

// Fluorescence

Material dye(const std::vector<double>& edges, const std::vector<double>& matrix, const std::vector<double>& emission) {
  Material paint = matt(Rgb(0));
  paint.fluorescence = Fluorescence{edges, matrix};
  EmissionSpectrum shine{edges, {}};
  for (const double e : emission) shine.radiance.push_back(e / pi);
  paint.emission_spectrum = shine;
  paint.emission = shine.colour();
  return paint;
}

/// The colour of bands of radiosity (W/m^2), each even within its edges.
Rgb colour_of(const std::vector<double>& edges, std::vector<double> radiosity) {
  for (double& b : radiosity) b /= pi;
  Vec3d sum(0);
  for (std::size_t k = 0; k < radiosity.size(); ++k) {
    for (int i = 0; i < 200; ++i) {
      const double width = edges[k + 1] - edges[k];
      sum += radiosity[k] / 200 * rec709_matching(edges[k] + (i + 0.5) / 200 * width);
    }
  }
  return Rgb(sum);
}

/// A closed room of dye that shines in ultraviolet only: B_uv = E / (1 - D_uv), B_visible = D B_uv / (1 - D_visible).
TEST(Fluorescence, TwoBandFurnaceByPath) {
  const auto table = optics()["fluorescence"]["furnace_two_band"];  // visible first
  const auto d = [&](int out, int in) { return table["D"][out][in].get<double>(); };
  const std::vector<double> edges{320, 380, 600};
  const Scene scene = room(dye(edges, {d(1, 1), d(1, 0), d(0, 1), d(0, 0)}, {table["E_uv_only"][1], 0}));
  const RayTracer tracer(scene);
  const Rgb truth = colour_of(edges, {0, table["B"][0].get<double>()});
  expect_colour(look(tracer, {-0.7, 0.3, 0.8}, {0.9, -0.5, -1}, spectral(path(16384))), Vec3d(truth), 0.03);
}

TEST(Fluorescence, SixBandFurnaceByPath) {
  const auto table = optics()["fluorescence"]["furnace_six_band"];
  std::vector<double> edges = table["bands_nm"].get<std::vector<double>>(), matrix;
  edges.push_back(740);
  for (const auto& row : table["D"]) {
    for (const double share : row) matrix.push_back(share);
  }
  const Scene scene = room(dye(edges, matrix, table["E"].get<std::vector<double>>()));
  const RayTracer tracer(scene);
  const Rgb truth = colour_of(edges, table["B"].get<std::vector<double>>());
  expect_colour(look(tracer, {-0.7, 0.3, 0.8}, {0.9, -0.5, -1}, spectral(path(16384))), Vec3d(truth), 0.03);
}

/// Under an ultraviolet lamp alone a dye shines by one bounce: what `path` sees up to it, `whitted` sees too.
TEST(Fluorescence, OneBounceByWhittedAndPath) {
  Scene scene;
  const std::vector<double> edges{320, 380, 500, 600};
  Material paint = matt(Rgb(0));
  paint.fluorescence = Fluorescence{edges, {0.1, 0, 0, 0.2, 0.1, 0, 0.4, 0, 0.3}};
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, paint);
  // The whole sky shines in ultraviolet: a dome of that light.
  Material dome = glow(Rgb(0));
  dome.emission_spectrum = EmissionSpectrum{{320, 380}, {2}};
  dome.double_sided = true;
  add_shape(scene, Sphere{{0, 0, 0}, 50}, dome);
  const RayTracer tracer(scene);
  // Irradiance pi L of the band; radiance D E / pi of the bands that it excites.
  const Rgb truth = colour_of(edges, {0, 0.2 * pi * 2, 0.4 * pi * 2});
  expect_colour(look(tracer, {0, 1, 0}, {0, -1, 0}, spectral(path(8192))), Vec3d(truth), 0.03);
}

/// Lit by a visible lamp, which whitted meets by shadow rays.
TEST(Fluorescence, WhittedSeesADyeUnderVioletLight) {
  Scene scene;
  const std::vector<double> edges{400, 440, 520, 620};
  Material paint = matt(Rgb(0));
  paint.fluorescence = Fluorescence{edges, {0.1, 0, 0, 0.2, 0.1, 0, 0.4, 0, 0.3}};
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, paint);
  Material lamp = glow(Rgb(0));
  lamp.emission_spectrum = EmissionSpectrum{{400, 440}, {5}};
  lamp.emission = lamp.emission_spectrum->colour();
  add_shape(scene, Disk{{0, 2, 0}, {0, -1, 0}, 0.5}, lamp);
  const RayTracer tracer(scene);
  const double irradiance = pi * 5 * 0.25 / (4 + 0.25);  // of a disk seen from its axis: pi L r^2 / (h^2 + r^2)
  const Rgb truth = colour_of(edges, {0.1 * irradiance, 0.2 * irradiance, 0.4 * irradiance});
  for (RenderOptions options : {spectral(whitted(4096)), spectral(path(8192))}) {
    options.max_depth = 1;
    expect_colour(look(tracer, {0.3, 1, 0}, {-0.3, -1, 0}, options), Vec3d(truth), 0.03);
  }
}

// Under light longer than all that it absorbs a dye only reflects.
TEST(Fluorescence, NothingIsRadiatedAtShorterWavelengths) {
  Scene scene;
  const std::vector<double> edges{400, 480, 560, 640};
  Material paint = matt(Rgb(0));
  paint.fluorescence = Fluorescence{edges, {0, 0, 0, 0.5, 0, 0, 0.5, 0.9, 0}};  // reflects nothing, radiates all
  add_plane(scene, {0, 0, 0}, {0, 1, 0}, paint);
  Material dome = glow(Rgb(0));
  dome.emission_spectrum = EmissionSpectrum{{560, 640}, {2}};
  dome.emission = dome.emission_spectrum->colour();
  dome.double_sided = true;
  add_shape(scene, Sphere{{0, 0, 0}, 50}, dome);
  const RayTracer tracer(scene);
  for (const RenderOptions& options : {spectral(whitted(256)), spectral(path(256))}) {
    EXPECT_EQ(look(tracer, {0, 1, 0}, {0, -1, 0}, options).radiance, Rgb(0));
  }
}

}  // namespace
}  // namespace penumbra
