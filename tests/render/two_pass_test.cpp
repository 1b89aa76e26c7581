#include "penumbra/render/two_pass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/render/radiosity_view.h"
#include "penumbra/render/solution_light.h"
#include "penumbra/scene/builtin_scenes.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using std::numbers::pi;

/// A scene with the light of its solution.
struct Lit {
  Scene scene;
  std::unique_ptr<RadiositySetup> setup;
  SceneRadiosity solved;
  MadePatchMesh faces;
  std::unique_ptr<LampIrradiance> lamps;
  std::unique_ptr<RayTracer> tracer;
  std::unique_ptr<SolutionLight> light;

  Lit(Scene given, std::size_t elements, const char* form_factors = "auto", int resolution = 32,
      Subdivision subdivision = Subdivision::uniform)
      : scene(std::move(given)) {
    RadiositySetupOptions options;
    options.subdivision = subdivision;
    options.element_count = elements;
    options.form_factors = form_factors;
    options.factors.tolerance = 1e-3;
    options.factors.resolution = std::string(form_factors) == "hemicube" ? resolution : 0;
    options.factors.rays = std::string(form_factors) == "ray-cast" ? 4096 : 0;
    options.specular_rays = 64;
    setup = make_radiosity_setup(scene, options);
    faces = make_element_faces(scene, PatchSides::both, 32);
    lamps = std::make_unique<LampIrradiance>(scene, faces.mesh);
    tracer = std::make_unique<RayTracer>(scene);
    solve_again();
  }
  /// After a change of the setup.
  void solve_again() {
    solved = solve(*setup, {});
    light = std::make_unique<SolutionLight>(*tracer, setup->mesh, solved.solution.irradiance, solved.caustics, *lamps);
  }
  [[nodiscard]] Image draw(const Camera& camera, int size, int samples, int gather = 0) const {
    RenderOptions options;
    options.width = options.height = size;
    options.samples_per_pixel = samples;
    options.final_gather = gather;
    options.max_depth = 32;
    options.min_throughput = 1e-5;
    return render(*tracer, *light, camera, options).image;
  }
};

double mean(const Image& image) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) sum += static_cast<double>(image.rgb(x, y).y);
  }
  return sum / (image.width * image.height);
}

/// A box about the origin, fronts inwards, all walls alike.
Scene furnace(double reflectance, double radiance) {
  Scene scene;
  Material wall = testing::matt(Rgb(static_cast<float>(reflectance)));
  wall.emission = Rgb(static_cast<float>(radiance));
  Mesh box;
  for (int k = 0; k < 8; ++k) box.positions.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  const std::array<std::array<std::uint32_t, 4>, 6> walls{
      {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
  for (const auto& w : walls) {
    box.triangles.push_back({w[0], w[1], w[2]});
    box.triangles.push_back({w[0], w[2], w[3]});
  }
  testing::add_mesh(scene, box, wall);
  return scene;
}

Camera camera_inside() { return {.name = "eye", .to_world = look_at({0.8, 0.7, 0.8}, {0, 0, 0}, {0, 1, 0})}; }

TEST(TwoPass, SlowEverythingInAFurnaceLooksAlike) {
  Scene scene = furnace(0.5, 1);
  testing::add_shape(scene, Sphere{{0.3, -0.3, -0.2}, 0.3}, testing::mirror(Rgb(1)));
  testing::add_shape(scene, Sphere{{-0.4, 0.1, 0.2}, 0.3}, testing::glass(1.5F));
  const Lit lit(std::move(scene), 2500, "hemicube");
  for (const int gather : {0, 8}) {
    const Image image = lit.draw(camera_inside(), 16, 4, gather);
    const double noise = gather > 0 ? 0.3 : 0.06;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) EXPECT_NEAR(image.rgb(x, y).y, 2, noise) << x << ' ' << y << ' ' << gather;
    }
    EXPECT_NEAR(mean(image), 2, 0.02);
  }
}

TEST(TwoPass, WithoutMirrorsItIsTheRadiosityView) {
  const Lit lit(make_builtin_scene("cornell-box"), 1500);
  const RadiosityView view(lit.setup->mesh, lit.solved.solution.irradiance, lit.scene, {.lamps = lit.lamps.get()});
  RenderOptions options;
  options.width = options.height = 48;
  options.samples_per_pixel = 4;
  const Image radiosity = render(view, lit.scene.cameras[0], options).image;
  const Image two_pass = lit.draw(lit.scene.cameras[0], 48, 4);
  EXPECT_NEAR(mean(two_pass), mean(radiosity), 0.005 * mean(radiosity));
  double off = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      off += std::abs(static_cast<double>(two_pass.rgb(x, y).y) - static_cast<double>(radiosity.rgb(x, y).y));
    }
  }
  EXPECT_LT(off / (48 * 48), 0.02 * mean(radiosity));
}

// Surfaces reflect on both sides: which way round a wall is makes no difference.
TEST(TwoPass, FlippedFacesHaveTheSameLight) {
  Scene scene = make_builtin_scene("cornell-box");
  const Lit straight(scene, 1200);
  for (Mesh& mesh : scene.meshes) {
    if (scene.materials[mesh.material_of(0)].emits()) continue;
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    for (std::size_t f = 0; f + 1 < mesh.face_offsets.size(); ++f) {
      std::reverse(mesh.face_vertices.begin() + mesh.face_offsets[f],
                   mesh.face_vertices.begin() + mesh.face_offsets[f + 1]);
    }
  }
  const Lit flipped(scene, 1200);
  const Image a = straight.draw(scene.cameras[0], 32, 4), b = flipped.draw(scene.cameras[0], 32, 4);
  EXPECT_NEAR(mean(b), mean(a), 0.005 * mean(a));
}

TEST(TwoPass, ThreadedTheSameBits) {
  Scene scene = furnace(0.5, 1);
  Mesh plate;
  plate.positions = {{-0.5, -0.5, -0.5}, {0.5, -0.5, -0.5}, {0, 0.5, -0.3}};
  plate.triangles = {{0, 1, 2}};
  testing::add_mesh(scene, plate, testing::mirror(Rgb(0.9F)));
  std::vector<float> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const Lit lit(scene, 200, "hemicube");
    const Image image = lit.draw(camera_inside(), 8, 1, 4);
    if (first.empty()) first = image.data;
    EXPECT_EQ(image.data, first) << threads;
  }
}

// Adaptive sampling decides by sums of samples, which must not depend on threads either.
TEST(TwoPass, ThreadedAdaptiveSamplingDrawsTheSameBits) {
  const Lit lit(make_builtin_scene("cornell-box"), 120, "hemicube", 16);
  const RadiosityView view(lit.setup->mesh, lit.solved.solution.irradiance, lit.scene);
  RenderOptions options;
  options.width = options.height = 24;
  options.samples_per_pixel = 48;
  options.noise = 0.3;
  std::vector<float> first[2];
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const Camera& camera = lit.scene.cameras.at(0);
    const RenderResult both[2] = {render(*lit.tracer, *lit.light, camera, options), render(view, camera, options)};
    for (int k = 0; k < 2; ++k) {
      EXPECT_LT(both[k].mean_samples, 48);
      if (first[k].empty()) first[k] = both[k].image.data;
      EXPECT_EQ(both[k].image.data, first[k]) << threads;
    }
  }
}

/// Means of blocks of 4 x 4 pixels of a channel, row by row.
std::vector<double> block_means(const Image& image, const std::string& channel) {
  const auto found = std::find(image.channels.begin(), image.channels.end(), channel);
  const auto at = static_cast<std::size_t>(found - image.channels.begin());
  std::vector<double> means;
  for (int y0 = 0; y0 < image.height; y0 += 4) {
    for (int x0 = 0; x0 < image.width; x0 += 4) {
      double sum = 0;
      for (int k = 0; k < 16; ++k) sum += static_cast<double>(image.pixel(x0 + k % 4, y0 + k / 4)[at]);
      means.push_back(sum / 16);
    }
  }
  return means;
}

// Caustics are where a path tracer is noisiest, and as sharp as the elements here. Without them (in both: light that
// reaches a diffuse surface from the lamp by way of mirror or glass, on any bounce) the two agree block by block, all
// over the picture: corners, contacts and shadows too.
TEST(TwoPass, SlowOutsideCausticsBlocksAgreeWithPathTracing) {
  Lit lit(make_builtin_scene("cornell-spheres"), 4000, "ray-cast");
  leave_caustics_out(*lit.setup);
  lit.solve_again();
  const Camera& camera = lit.scene.cameras[0];
  const Image two_pass = lit.draw(camera, 64, 128, 16);
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = 64;
  options.samples_per_pixel = 512;
  options.caustics = false;
  options.aovs = {Aov::variance};
  const Image path = render(*lit.tracer, camera, options).image;
  EXPECT_NEAR(mean(two_pass), mean(path), 0.005 * mean(path));
  const std::vector<double> ours = block_means(two_pass, "R"), reference = block_means(path, "R");
  const std::vector<double> variance = block_means(path, "variance.R");
  double squares = 0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const double error = std::abs(ours[k] - reference[k]) / reference[k];
    const double noise = std::sqrt(variance[k] / 16) / reference[k];  // of the reference
    squares += error * error;
    EXPECT_LT(error, 0.03 + 3 * noise) << "block " << k % 16 << ' ' << k / 16;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(ours.size())), 0.02);
}

// With caustics the means agree: nothing is lost, nothing counted twice, by elements and by gathering.
TEST(TwoPass, SlowCornellSpheresHaveTheMeanOfPathTracing) {
  const Lit lit(make_builtin_scene("cornell-spheres"), 4000, "ray-cast");
  const Camera& camera = lit.scene.cameras[0];
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = 64;
  options.samples_per_pixel = 512;
  const double reference = mean(render(*lit.tracer, camera, options).image);
  EXPECT_NEAR(mean(lit.draw(camera, 64, 16)), reference, 0.01 * reference);
  EXPECT_NEAR(mean(lit.draw(camera, 64, 16, 16)), reference, 0.01 * reference);
}

// A point light's caustic is found by no ray from the eye: gathering must take it from the solution.
TEST(TwoPass, GatheringKeepsWhatAMirrorBringsFromAPointLight) {
  Scene scene;
  Mesh floor;
  floor.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  testing::add_mesh(scene, floor, testing::matt(Rgb(0.5F)));
  Mesh mirror;
  mirror.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}};
  mirror.triangles = {{0, 1, 2}, {0, 2, 3}};
  testing::add_mesh(scene, mirror, testing::mirror(Rgb(1)));
  scene.lights.push_back({.name = "point", .kind = PointLight{.position = {0, 1, 0}, .intensity = Rgb(1.0F)}});
  const Lit lit(scene, 200);
  const Camera above{.name = "above", .to_world = look_at({0, 1.5, 1}, {0, 0, 0.2}, {0, 1, 0})};
  const double interpolated = mean(lit.draw(above, 16, 4)), gathered = mean(lit.draw(above, 16, 4, 4));
  EXPECT_NEAR(gathered, interpolated, 0.01 * interpolated);
  // The light and its image behind the mirror.
  EXPECT_GT(interpolated, 0);
}

}  // namespace
}  // namespace penumbra
