// Radiosity against a picture of the Cornell box that another renderer made by path tracing.

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "laws/cornell_reference.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/render/radiosity_view.h"
#include "penumbra/render/render.h"
#include "penumbra/scene/builtin_scenes.h"

namespace penumbra {
namespace {

using namespace cornell_reference;

Image radiosity_picture(std::size_t elements, Subdivision subdivision, int side, int samples) {
  const Scene scene = make_builtin_scene("cornell-box");
  RadiositySetupOptions setup_options;
  setup_options.subdivision = subdivision;
  setup_options.element_count = elements;
  setup_options.factors.tolerance = 1e-3;
  const auto setup = make_radiosity_setup(scene, setup_options);
  const SceneRadiosity solved = solve(*setup, {});
  const MadePatchMesh faces = make_element_faces(scene, PatchSides::both, 32);
  const LampIrradiance lamps(scene, faces.mesh);
  const RadiosityView view(setup->mesh, solved.solution.irradiance, scene, {.lamps = &lamps});
  RenderOptions options;
  options.width = options.height = side;
  options.samples_per_pixel = samples;
  return render(view, scene.cameras.at(0), options).image;
}

double error_at(std::size_t elements, Subdivision subdivision) {
  const double error = block_error(radiosity_picture(elements, subdivision, reference_side, 16), read_reference());
  std::printf("block error %.4f at %zu elements\n", error, elements);
  return error;
}

Image path_picture(int side, int samples, std::uint64_t seed) {
  const Scene scene = make_builtin_scene("cornell-box");
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = side;
  options.samples_per_pixel = samples;
  options.seed = seed;
  return render(RayTracer(scene), scene.cameras.at(0), options).image;
}

#ifndef __SANITIZE_ADDRESS__
// The reference's own noise is 0.5 %. Uniform elements that are half covered, where boxes meet the floor and around the
// lamp, keep the error at 2.4 %; adaptive ones are cut along the contacts.
TEST(CornellRadiositySlow, TwentyThousandAdaptiveElementsMeetItWithinTwoPercent) {
  EXPECT_LE(error_at(20'000, Subdivision::adaptive), 0.02);
}

// The same against this program's own paths, whose noise two seeds tell: half of their difference is that of their
// mean.
TEST(CornellRadiositySlow, TwentyThousandAdaptiveElementsMeetPathsOfThreeThousandthsNoiseWithinTwoPercent) {
  constexpr int side = 64, samples = 3072;
  Image paths = path_picture(side, samples, 0);
  const Image others = path_picture(side, samples, 1);
  const double noise = block_error(others, paths) / 2;
  for (std::size_t k = 0; k < paths.data.size(); ++k) paths.data[k] = 0.5F * (paths.data[k] + others.data[k]);
  const double error = block_error(radiosity_picture(20'000, Subdivision::adaptive, side, 256), paths);
  std::printf("block error %.4f, noise of the reference %.4f\n", error, noise);
  EXPECT_LE(noise, 0.003);
  EXPECT_LE(error, 0.02);
}

TEST(CornellRadiosity, ItNearsTheReferenceAsElementsShrink) {
  const double coarse = error_at(500, Subdivision::uniform), fine = error_at(2000, Subdivision::uniform);
  EXPECT_LE(fine, 0.1);
  EXPECT_LE(fine, 0.75 * coarse);
}
#endif

// Every pixel of a furnace has the same radiance: no seam, no leak, no speck.
TEST(RadiosityPicture, AFurnaceIsEven) {
  const Scene scene = make_builtin_scene("furnace?rho=0.5&emission=1");
  RadiositySetupOptions setup_options;
  setup_options.element_count = 600;
  setup_options.factors.tolerance = 1e-6;
  const auto setup = make_radiosity_setup(scene, setup_options);
  SolverOptions solver;
  solver.tolerance = 1e-10;
  const SceneRadiosity solved = solve(*setup, solver);
  for (const bool smooth : {true, false}) {
    const RadiosityView view(setup->mesh, solved.solution.irradiance, scene, {.smooth = smooth});
    RenderOptions options;
    options.width = 96;
    options.height = 64;
    options.samples_per_pixel = 4;
    const Camera camera = scene.cameras.empty() ? Camera{} : scene.cameras[0];
    const Image image = render(view, camera, options).image;
    for (const float v : image.data) ASSERT_NEAR(v, 2.0F, 2e-5F);
  }
}

TEST(RadiosityPicture, ThreadedPicturesHaveTheSameBits) {
  const Scene scene = make_builtin_scene("cornell-box");
  RadiositySetupOptions setup_options;
  setup_options.element_count = 300;
  Image images[2];
  for (int k = 0; k < 2; ++k) {
    const ThreadLimit limit(1 + 3 * k);
    const auto setup = make_radiosity_setup(scene, setup_options);
    const SceneRadiosity solved = solve(*setup, {});
    const RadiosityView view(setup->mesh, solved.solution.irradiance, scene);
    RenderOptions options;
    options.width = options.height = 48;
    images[k] = render(view, scene.cameras.at(0), options).image;
  }
  EXPECT_EQ(images[0].data, images[1].data);
}

// A two-sided plate of one reflectance, lit from one side: its other side is as dark as what it sees.
TEST(RadiosityPicture, SidesAreToldApart) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].base_colour = Rgb(0.5F);
  scene.materials[0].specular = 0;
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({.name = "plate", .mesh = 0, .to_world = Mat4d(1.0)});
  scene.lights.push_back({.name = "sun", .kind = DirectionalLight{.direction = {0, 0, -1}, .irradiance = Rgb(3.0F)}});
  const auto setup = make_radiosity_setup(scene, {});
  const SceneRadiosity solved = solve(*setup, {});
  const RadiosityView view(setup->mesh, solved.solution.irradiance, scene);
  const auto lit = view.look({.origin = {0.1, 0.2, 5}, .direction = {0, 0, -1}});
  const auto dark = view.look({.origin = {0.1, 0.2, -5}, .direction = {0, 0, 1}});
  EXPECT_NEAR(lit.radiance.x, 0.5 * 3 / std::numbers::pi, 1e-6);
  EXPECT_TRUE(dark.hit);
  EXPECT_EQ(dark.radiance, Rgb(0.0F));
  EXPECT_LT(lit.normal.z * dark.normal.z, 0);
}

}  // namespace
}  // namespace penumbra
