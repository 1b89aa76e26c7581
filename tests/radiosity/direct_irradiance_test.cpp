#include "penumbra/radiosity/direct_irradiance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "radiosity/scene_makers.h"

namespace penumbra {
namespace {

using std::numbers::pi;

PatchMesh elements_of(const Scene& scene, double size, PatchSides sides = PatchSides::both) {
  return make_uniform_elements(scene, {.element_size = size, .sides = sides}).mesh;
}

double received(const PatchMesh& mesh, const DirectIrradiance& light) {
  double sum = 0;
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) sum += mesh.areas[e] * light.irradiance[3 * e];
  return sum;
}

void add_light(Scene& scene, const decltype(Light::kind)& kind) { scene.lights.push_back({"lamp", kind}); }

TEST(DirectIrradiance, APointLightOverAFloorFollowsItsClosedForm) {
  // CIE 171:2006, test 5.2: E = I cos / d^2, here 10000 lm at 3 m; elements of 1 cm are points.
  const double intensity = 10000 / (4 * pi);
  for (const double r : {0.0, 1.0, 2.0, 3.0, 5.0}) {
    Scene scene = polygon_scene({floor_rectangle(r - 0.005, r + 0.005, -0.005, 0.005)});
    add_light(scene, PointLight{{0, 0, 3}, Rgb(static_cast<float>(intensity))});
    const PatchMesh mesh = elements_of(scene, 0, PatchSides::front);
    const double expected = intensity * 3 / std::pow(9 + r * r, 1.5);
    EXPECT_NEAR(direct_irradiance(scene, mesh).irradiance[0], expected, 1e-4 * expected);
  }
}

TEST(DirectIrradiance, AnAreaLightOverAFloorFollowsItsClosedForm) {
  // CIE 171:2006, test 5.3: a panel of 2 m by 1 m and 1000 cd/m^2 at 3 m, by E = pi L F; lx at floor points.
  struct Point {
    double x, y, expected;
  };
  for (const auto& [x, y, expected] :
       {Point{0, 0, 203.62596216665835}, Point{1, 0, 172.06591809605914}, Point{0, 1, 167.82868912970798},
        Point{2, 1, 93.93655078804517}, Point{4, 0, 30.802774098696283}}) {
    const Polygon floor = floor_rectangle(x - 0.01, x + 0.01, y - 0.01, y + 0.01);
    Scene scene = polygon_scene({floor});
    scene.materials.push_back(matt(0, 1000));
    add_polygons(scene, "panel", {reversed(floor_rectangle(-1, 1, -0.5, 0.5, 3))}, 1);
    const MadePatchMesh faces = make_element_faces(scene, PatchSides::both, 8);
    PatchMesh painted = faces.mesh;
    paint_elements(scene, 8, painted);
    EXPECT_NEAR(LampIrradiance(scene, painted).view(floor).at({x, y, 0}).x, expected, 1e-9 * expected);
  }
}

TEST(DirectIrradiance, AClosedRoomReceivesTheWholeFluxOfAPointLight) {
  // CIE 171:2006, test 5.8: a cube of 4 m with 10000 lm in its middle has 10000 / 96 lx on average.
  Scene scene = polygon_scene(room({4, 4, 4}));
  add_light(scene, PointLight{{2, 2, 2}, Rgb(static_cast<float>(10000 / (4 * pi)))});
  const PatchMesh mesh = elements_of(scene, 0.5);
  const DirectIrradiance light = direct_irradiance(scene, mesh);
  EXPECT_NEAR(received(mesh, light), 10000, 1e-3);
  EXPECT_NEAR(light.light_power[0], 10000, 1e-3);
  // Nothing outside.
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    if (mesh.surfaces[e].back) {
      EXPECT_EQ(light.irradiance[3 * e], 0);
    }
  }
}

TEST(DirectIrradiance, ARoomWithABoxLosesNothing) {
  // An inner box casts shadows on the walls; what they lose it receives. Shares by shadow rays: a few per mille.
  std::vector<Polygon> faces = room({4, 4, 4});
  for (const Polygon& p : reversed(room({1, 1, 1}))) faces.push_back(moved(p, {0.7, 0.9, 0.5}));
  Scene scene = polygon_scene(faces);
  add_light(scene, PointLight{{2.5, 2.2, 3.1}, Rgb(1)});
  const PatchMesh mesh = elements_of(scene, 0.25);
  const DirectIrradiance light = direct_irradiance(scene, mesh);
  EXPECT_NEAR(received(mesh, light), 4 * pi, 3e-3 * 4 * pi);
  const DirectIrradiance more = direct_irradiance(scene, mesh, {.samples = 64});
  EXPECT_NEAR(received(mesh, more), 4 * pi, 1e-3 * 4 * pi);
}

TEST(DirectIrradiance, TheSunGivesItsCosineAndCastsASquareShadow) {
  // A square metre at 1 m over a floor, the sun 30 degrees from the zenith: the shadow is a square, moved.
  Scene scene = polygon_scene({floor_rectangle(-3, 3, -3, 3), floor_rectangle(-0.5, 0.5, -0.5, 0.5, 1)});
  const double slant = pi / 6;
  add_light(scene, DirectionalLight{{std::sin(slant), 0, -std::cos(slant)}, {2, 1, 0}});
  const PatchMesh mesh = elements_of(scene, 0.1);
  const DirectIrradiance light = direct_irradiance(scene, mesh);
  const double lit = std::cos(slant), shift = std::tan(slant);
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    const Vec3d c = mesh.centroids[e];
    const double from_shadow = std::max(std::abs(c.x - shift), std::abs(c.y)) - 0.5;
    if (mesh.surfaces[e].back) {
      EXPECT_EQ(light.irradiance[3 * e], 0);
    } else if (c.z > 0.5 || from_shadow > 0.08) {
      EXPECT_NEAR(light.irradiance[3 * e], 2 * lit, 1e-6);
      EXPECT_NEAR(light.irradiance[3 * e + 1], lit, 1e-6);
    } else if (from_shadow < -0.08) {
      EXPECT_EQ(light.irradiance[3 * e], 0);
    }
  }
  // What reaches the scene is what falls on the floor's outline.
  EXPECT_NEAR(received(mesh, light), 36 * 2 * lit, 0.01 * 36 * 2 * lit);
  EXPECT_NEAR(light.light_power[0], received(mesh, light), 1e-9);
}

TEST(DirectIrradiance, ASpotSendsItsFluxThroughItsCone) {
  const SpotLight spot{{0, 0, 2}, {0, 0, -1}, Rgb(3), 0.3, 0.6};
  Scene scene = polygon_scene({floor_rectangle(-2, 2, -2, 2)});
  add_light(scene, spot);
  const PatchMesh mesh = elements_of(scene, 0.1, PatchSides::front);
  const DirectIrradiance light = direct_irradiance(scene, mesh);
  EXPECT_NEAR(received(mesh, light), light.light_power[0], 1e-3 * light.light_power[0]);
  // Between the cones of its two angles.
  EXPECT_GT(light.light_power[0], 3 * 2 * pi * (1 - std::cos(0.3)));
  EXPECT_LT(light.light_power[0], 3 * 2 * pi * (1 - std::cos(0.6)));
}

TEST(DirectIrradiance, AnEvenSkyGivesPiTimesItsRadiance) {
  Scene scene = polygon_scene({floor_rectangle(-1, 1, -1, 1)});
  scene.environment = Environment{{0.5F, 1, 2}, {}, false};
  const PatchMesh mesh = elements_of(scene, 0.5);
  const DirectIrradiance light = direct_irradiance(scene, mesh);
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    EXPECT_NEAR(light.irradiance[3 * e], 0.5 * pi, 1e-6);
    EXPECT_NEAR(light.irradiance[3 * e + 2], 2 * pi, 1e-6);
  }
  scene.environment->backdrop_only = true;
  EXPECT_TRUE(direct_irradiance(scene, mesh).irradiance.empty());
}

TEST(DirectIrradiance, AWallHidesHalfTheSky) {
  // At the foot of an endless wall a floor sees half its sky; 100 m stand for endless.
  Scene scene =
      polygon_scene({floor_rectangle(0, 0.001, -0.5, 0.5), {{0, -100, 0}, {0, 100, 0}, {0, 100, 100}, {0, -100, 100}}});
  scene.environment = Environment{Rgb(1), {}, false};
  const PatchMesh mesh = elements_of(scene, 0, PatchSides::front);
  EXPECT_NEAR(direct_irradiance(scene, mesh, {.sky_samples = 4096}).irradiance[0], pi / 2, 0.01 * pi);
}

TEST(DirectIrradiance, APictureOfTheSkyIsIntegrated) {
  // Upper half red 1, lower half green 1: a wall sees half of either, a floor the upper one.
  Scene scene =
      polygon_scene({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{5, 0, 0}, {5, 0, 1}, {6, 0, 1}, {6, 0, 0}}});
  std::vector<float> texels;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 16; ++x) {
      texels.insert(texels.end(), {y < 4 ? 1.0F : 0.0F, y < 4 ? 0.0F : 1.0F, x == 3 && y == 2 ? 50.0F : 0.0F});
    }
  }
  scene.images.push_back({"sky", 16, 8, 3, texels});
  scene.environment = Environment{Rgb(1), 0, false};
  const PatchMesh mesh = elements_of(scene, 0, PatchSides::front);
  const DirectIrradiance light = direct_irradiance(scene, mesh, {.sky_samples = 4096});
  EXPECT_NEAR(light.irradiance[0], pi / 2, 0.01);  // the wall, facing z
  EXPECT_NEAR(light.irradiance[1], pi / 2, 0.01);
  EXPECT_NEAR(light.irradiance[3], pi, 0.02);  // the floor, facing y
  EXPECT_NEAR(light.irradiance[4], 0, 0.01);
  // A bright texel, by its solid angle: a ring of 1/16 turn between 45 and 67.5 degrees from the zenith.
  const auto ring = [](double from, double to) {
    return (std::sin(to) * std::sin(to) - std::sin(from) * std::sin(from)) / 2;
  };
  const double texel = 50 * (2 * pi / 16) * ring(2 * pi / 8, 3 * pi / 8);
  EXPECT_NEAR(light.irradiance[5], texel, 0.02 * texel);
}

TEST(DirectIrradiance, AClosedRoomKeepsTheSkyOut) {
  Scene scene = polygon_scene(room({1, 1.3, 0.7}));
  scene.environment = Environment{Rgb(1000), {}, false};
  add_light(scene, PointLight{{5, 0.2, 0.3}, Rgb(1000)});
  add_light(scene, DirectionalLight{normalize(Vec3d(1, 2, -3)), Rgb(1000)});
  const PatchMesh mesh = elements_of(scene, 0.1);
  const DirectIrradiance light = direct_irradiance(scene, mesh);
  for (std::size_t e = 0; e < mesh.patch_count(); ++e) {
    if (!mesh.surfaces[e].back) {
      EXPECT_EQ(light.irradiance[3 * e], 0) << e;
    }
  }
}

TEST(DirectIrradiance, TheSameBitsOnAnyNumberOfThreadsThreaded) {
  std::vector<Polygon> faces = room({4, 4, 4});
  for (const Polygon& p : reversed(room({1, 1, 1}))) faces.push_back(moved(p, {0.7, 0.9, 0.5}));
  faces.erase(faces.begin() + 1);  // no ceiling
  Scene scene = polygon_scene(faces);
  add_light(scene, PointLight{{2.5, 2.2, 3.1}, Rgb(1)});
  scene.environment = Environment{Rgb(1), {}, false};
  const PatchMesh mesh = elements_of(scene, 0.5);
  std::vector<double> one;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const auto light = direct_irradiance(scene, mesh).irradiance;
    if (threads == 1) one = light;
    EXPECT_EQ(light, one);
  }
}

}  // namespace
}  // namespace penumbra
