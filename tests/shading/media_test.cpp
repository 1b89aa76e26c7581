#include "penumbra/tracing/shading/media.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/shadow.h"
#include "test_paths.h"
#include "tracing/soup.h"

namespace penumbra {
namespace {

using testing::Dice;

Medium fog(const Rgb& absorption, const Rgb& scattering) {
  return {.name = "fog", .absorption = absorption, .scattering = scattering};
}

DensityGrid random_grid(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, const Bounds& box) {
  Dice dice(nx + 10 * ny + 100 * nz);
  DensityGrid grid{.cells = {nx, ny, nz}, .values = {}, .box = box};
  for (std::size_t i = 0; i < std::size_t{nx} * ny * nz; ++i) {
    grid.values.push_back(dice.unit() < 0.3 ? 0.0F : static_cast<float>(dice.between(0, 2)));
  }
  return grid;
}

Scene air_of(std::vector<Medium> media) {
  Scene scene;
  scene.materials.emplace_back();
  scene.media = std::move(media);
  for (std::uint32_t i = 0; i < scene.media.size(); ++i) scene.air.push_back(i);
  validate(scene);
  return scene;
}

Ray ray_of(const Vec3d& origin, const Vec3d& direction, double far) {
  return {.origin = origin, .direction = normalize(direction), .t_min = 0, .t_max = far};
}

TEST(Media, BeerAndLambert) {
  const auto optics = nlohmann::json::parse(std::ifstream(PENUMBRA_TEST_DATA "/optics.json"));
  for (const auto& c : optics["beer_lambert"]["cases"]) {
    const double sigma = c["sigma"], d = c["d"], t = c["T"];
    const Scene scene = air_of({fog(Rgb(static_cast<float>(sigma * 0.25)), Rgb(static_cast<float>(sigma * 0.75)))});
    const Media media(scene);
    // A point and a direction of no distinction.
    const Rgb left = media.transmittance(std::nullopt, ray_of({1, 2, 3}, {0.2, -0.5, 0.9}, d));
    EXPECT_NEAR(left.x, t, 1e-6 * t + 1e-12) << c;
  }
}

TEST(Media, AnInfiniteWayThroughFogLeavesNothingOfTheBandsThatItTakes) {
  const Scene scene = air_of({fog(Rgb(0.1F, 0, 0), Rgb(0))});
  const Rgb left = Media(scene).transmittance(std::nullopt, Ray{});
  EXPECT_EQ(left, Rgb(0, 1, 1));
}

TEST(Media, ABoxTakesWhatPassesThroughIt) {
  Medium m = fog(Rgb(1, 2, 3), Rgb(0));
  m.box = Bounds{{0, 0, 0}, {1, 1, 1}};
  const Scene scene = air_of({m});
  const Media media(scene);
  const Rgb across = media.transmittance(std::nullopt, ray_of({-5, 0.5, 0.5}, {1, 0, 0}, 100));
  EXPECT_NEAR(across.y, std::exp(-2.0), 1e-7);
  EXPECT_EQ(media.transmittance(std::nullopt, ray_of({-5, 1.5, 0.5}, {1, 0, 0}, 100)), Rgb(1));
  EXPECT_NEAR(media.transmittance(std::nullopt, ray_of({-5, 0.5, 0.5}, {1, 0, 0}, 5.25)).z, std::exp(-0.75), 1e-7);
}

// Trilinear density along a ray, by the exact rule against very many small steps.
TEST(Media, DensityGridsAreIntegratedExactly) {
  const Bounds box{{-1, 0, 2}, {1, 3, 3}};
  const DensityGrid grid = random_grid(4, 7, 3, box);
  const DensityField field(grid);
  Dice dice(5);
  for (int i = 0; i < 20; ++i) {
    const Vec3d a(dice.between(-1, 1), dice.between(0, 3), dice.between(2, 3));
    Vec3d b(dice.between(-1, 1), dice.between(0, 3), dice.between(2, 3));
    if (i == 0) b = a + Vec3d(0, 0.5 * (3 - a.y), 0);  // along an axis
    const Ray ray = ray_of(a, b - a, length(b - a));
    double sum = 0;
    constexpr int steps = 20000;
    for (int s = 0; s < steps; ++s) sum += field.at(ray.at(ray.t_max * (s + 0.5) / steps)) * ray.t_max / steps;
    EXPECT_NEAR(field.integral(ray, 0, ray.t_max), sum, 1e-6);
  }
}

TEST(Media, AnEvenGridIsAHomogeneousMedium) {
  const Bounds box{{0, 0, 0}, {2, 2, 2}};
  Medium even = fog(Rgb(0.5F), Rgb(0.1F));
  even.density = DensityGrid{.cells = {3, 2, 5}, .values = std::vector<float>(30, 0.5F), .box = box};
  const Scene scene = air_of({even});
  const Media media(scene);
  const Ray ray = ray_of({-1, 0.3, 0.4}, {1, 0.2, 0.1}, 100);
  const double inside = 2 / ray.direction.x;
  EXPECT_NEAR(media.transmittance(std::nullopt, ray).x, std::exp(-0.3 * inside), 1e-6);
}

// What a flight brings in the mean: of the light that passes, the transmittance; of the light that is scattered, the
// integral of transmittance times scattering. Per band, in coloured media and in grids, and however the throughput is
// divided among the bands.
TEST(Media, FlightsAreUnbiasedPerBand) {
  Medium smoke = fog(Rgb(0.2F, 0.5F, 0.1F), Rgb(1.0F, 0.4F, 2.0F));
  smoke.density = random_grid(5, 4, 6, {{0, 0, 0}, {2, 1, 1}});
  const std::vector<std::vector<Medium>> airs{{fog(Rgb(0.1F), Rgb(0.6F))},
                                              {fog(Rgb(0.3F, 0, 0.1F), Rgb(0.2F, 1.5F, 0.5F))},
                                              {smoke},
                                              {smoke, fog(Rgb(0.05F, 0.1F, 0), Rgb(0.3F))}};
  for (const auto& air : airs) {
    const Scene scene = air_of(air);
    const Media media(scene);
    const Ray ray = ray_of({-0.5, 0.4, 0.45}, {1, 0.1, 0.05}, 3);
    Vec3d scattered(0);
    constexpr int steps = 3000;
    for (int s = 0; s < steps; ++s) {
      Ray part = ray;
      part.t_max = ray.t_max * (s + 0.5) / steps;
      Vec3d sigma(0);
      for (const Media::Lobe& lobe : media.lobes(std::nullopt, ray.at(part.t_max))) sigma += Vec3d(lobe.scattering);
      scattered += sigma * Vec3d(media.transmittance(std::nullopt, part)) * ray.t_max / double(steps);
    }
    const Vec3d passed(media.transmittance(std::nullopt, ray));

    const Rgb throughput(0.2F, 1.0F, 0.5F);
    Vec3d sum_passed(0), sum_scattered(0), square_passed(0), square_scattered(0);
    Dice dice(11);
    constexpr int draws = 60000;
    for (int i = 0; i < draws; ++i) {
      CounterRng rng(static_cast<std::uint64_t>(i) * 77 + 5);
      const auto flight = media.fly(std::nullopt, ray, throughput, dice.square(), rng);
      const Vec3d w(flight.weight);
      (flight.collided ? sum_scattered : sum_passed) += w;
      (flight.collided ? square_scattered : square_passed) += w * w;
      // Nothing is gained: the bands together carry no more than before.
      ASSERT_LE(dot(Vec3d(throughput), w), 1.7 * (1 + 1e-6));
      if (flight.collided) {
        ASSERT_GT(media.extinction(std::nullopt, ray.at(flight.distance)).y, 0);
      }
    }
    const auto expect = [&](const Vec3d& sum, const Vec3d& square, const Vec3d& truth) {
      for (int b = 0; b < 3; ++b) {
        const double mean = sum[b] / draws;
        const double error = std::sqrt(std::max(0.0, square[b] / draws - mean * mean) / draws);
        EXPECT_NEAR(mean, truth[b], 4 * error + 1e-5);
      }
    };
    expect(sum_passed, square_passed, passed);
    expect(sum_scattered, square_scattered, scattered);
  }
}

/// A box of `m` whose walls are not seen.
Scene hidden_box(const Medium& m, const Vec3d& lower, const Vec3d& upper) {
  Scene scene = testing::scene_of(testing::box(lower, upper));
  scene.media = {m};
  scene.materials[0].medium = 0;
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].alpha = 0;
  return scene;
}

TEST(Media, MediaInClosedMeshesCastShadows) {
  const Scene scene = hidden_box(fog(Rgb(1, 0.5F, 0), Rgb(0)), {-1, -1, -1}, {1, 1, 1});
  const RayTracer tracer(scene);
  const Shadow shadow(tracer, false);
  EXPECT_FALSE(shadow.is_binary());
  const Rgb across = shadow.transmittance(ray_of({-3, 0.1, 0.2}, {1, 0, 0}, 6));
  EXPECT_NEAR(across.x, std::exp(-2.0), 1e-6);
  EXPECT_NEAR(across.y, std::exp(-1.0), 1e-6);
  EXPECT_EQ(across.z, 1);
  // From within: the wall that is met from inside tells where the ray is.
  EXPECT_NEAR(shadow.transmittance(ray_of({0.5, 0.1, 0.2}, {1, 0, 0}, 6)).x, std::exp(-0.5), 1e-6);
  // With both ends within, the ray must be told.
  Interior inside;
  inside.note_inside(0);
  EXPECT_NEAR(shadow.transmittance(ray_of({0.5, 0.1, 0.2}, {1, 0, 0}, 0.25), inside).x, std::exp(-0.25), 1e-6);
  EXPECT_EQ(shadow.transmittance(ray_of({3, 0.1, 0.2}, {1, 0, 0}, 6)), Rgb(1));
}

// Inside a closed mesh its own medium stands instead of the air's.
TEST(Media, ClosedMeshesKeepTheFogOut) {
  Scene scene = hidden_box(fog(Rgb(0), Rgb(0)), {-1, -1, -1}, {1, 1, 1});
  scene.media.push_back(fog(Rgb(1), Rgb(0)));
  scene.air = {1};
  const RayTracer tracer(scene);
  EXPECT_NEAR(Shadow(tracer, false).transmittance(ray_of({-3, 0.1, 0.2}, {1, 0, 0}, 6)).x, std::exp(-4.0), 1e-6);
}

}  // namespace
}  // namespace penumbra
