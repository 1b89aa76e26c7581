// Wavelengths followed from the lamps: what a prism throws on a screen.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "penumbra/math/cie_colour.h"
#include "penumbra/math/dispersion.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/tracing/shading/fresnel.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "render/spectral_truth.h"

namespace penumbra {
namespace {

using namespace testing;
using std::numbers::pi;

RenderOptions particles(int width, int height, int samples) {
  RenderOptions options = spectral({});
  options.integrator = IntegratorKind::light;
  options.width = width;
  options.height = height;
  options.samples_per_pixel = samples;
  options.max_depth = 0;
  return options;
}

/// Refraction by Snell's law in vectors. @param normal against `way`. @param eta index before over that behind.
Vec3d snell(const Vec3d& way, const Vec3d& normal, double eta) {
  const double cosine = -dot(way, normal);
  return eta * way + (eta * cosine - std::sqrt(1 - eta * eta * (1 - cosine * cosine))) * normal;
}

/// The prism of the built-in scene: its edge points to -x, the beam meets its faces at -face and, the d line, at +face.
class BeamThroughPrism {
 public:
  explicit BeamThroughPrism(const Scene& scene) {
    for (const Material& m : scene.materials) {
      if (m.dispersion) glass_ = *m.dispersion;
    }
    half_ = std::asin(refractive_index(glass_, line_d) / 2) - pi / 6;
    out_ = Vec3d(std::sin(half_), 0, std::cos(half_));
    foot_ = face_ + 0.5 * out_;
    across_ = Vec3d(out_.z, 0, -out_.x);
  }

  /// Where on the screen a wavelength lands (m along `across`) that comes in the plane of the beam's axis, so much
  /// higher, rad; and how much of it the two faces let through.
  struct Landing {
    double place, passed;
  };
  [[nodiscard]] Landing landing(double nm, double rise) const {
    const double n = refractive_index(glass_, nm);
    const Vec3d in = std::cos(rise) * Vec3d(-std::sin(half_), 0, std::cos(half_)) + std::sin(rise) * Vec3d(0, 1, 0);
    const Vec3d first(-0.5, 0, -std::cos(pi / 6)), second(-0.5, 0, std::cos(pi / 6));
    const Vec3d inside = snell(in, first, 1 / n);
    const Vec3d leaves = -face_ + dot(2.0 * face_, second) / dot(inside, second) * inside;
    const Vec3d beyond = snell(inside, -second, n);
    const Vec3d on_screen = leaves + dot(foot_ - leaves, out_) / dot(beyond, out_) * beyond;
    const double enters = 1 - fresnel_dielectric(-dot(in, first), 1, n).mean();
    return {dot(on_screen - foot_, across_), enters * (1 - fresnel_dielectric(dot(beyond, second), 1, n).mean())};
  }

  [[nodiscard]] Camera camera() const {
    const Vec3d middle = foot_ + Vec3d(0, 0.06, 0);
    return {.name = "",
            .to_world = look_at(middle - 0.3 * out_ + Vec3d(0, 0.15, 0), middle, Vec3d(0, 1, 0)),
            .lens = PerspectiveLens{0.25}};
  }
  /// Place on the screen that a camera's ray meets, and a pixel's area there, up to a factor.
  struct OnScreen {
    double place, area;
  };
  [[nodiscard]] OnScreen on_screen(const Ray& ray, const Vec3d& forward) const {
    const double cosine = dot(ray.direction, out_);
    const double t = dot(foot_ - ray.origin, out_) / cosine;
    return {dot(ray.at(t) - foot_, across_), t * t * std::pow(dot(ray.direction, forward), 3) / cosine};
  }

 private:
  static constexpr double to_edge = 0.065;
  Dispersion glass_;
  Vec3d face_{0, 0, to_edge* std::tan(pi / 6)};
  double half_ = 0;
  Vec3d out_{0}, foot_{0}, across_{0};
};

// The mean place of red, green and blue on the screen is that of all wavelengths, each sent by Snell's law, weakened by
// Fresnel's formulae and weighted by the eye's matching functions.
TEST(SpectralLight, APrismThrowsEachColourWhereSnellSendsIt) {
  Scene scene = make_builtin_scene("prism?beam=1");
  const BeamThroughPrism prism(scene);
  std::erase_if(scene.instances, [](const Instance& i) { return i.name == "lamp" || i.name == "table"; });
  const RayTracer tracer(scene);
  const Camera camera = prism.camera();
  const Vec3d forward = -Vec3d(camera.to_world[2]);

  const auto& spot = std::get<SpotLight>(scene.lights[0].kind);
  Vec3d weights(0), places(0);
  for (int i = 0; i < 800; ++i) {
    const double nm = shortest_visible + (i + 0.5) / 800 * (longest_visible - shortest_visible);
    for (int k = 0; k < 10; ++k) {  // over the height of the slit, 25 mm up and down, 0.8 m from the lamp
      const double rise = std::atan((k - 4.5) / 5 * 0.025 / 0.8);
      const auto [place, passed] = prism.landing(nm, rise);
      const double window = spot_window(spot, normalize(spot.direction + std::tan(rise) * Vec3d(0, 1, 0)));
      const Vec3d weight = window * passed * white_radiance(nm) * rec709_matching(nm);
      weights += weight;
      places += place * weight;
    }
  }
  const Vec3d truth = places / weights;

  constexpr int width = 96, height = 32, seeds = 8;
  Vec3d mean(0), squares(0);
  for (int seed = 0; seed < seeds; ++seed) {
    RenderOptions options = particles(width, height, 20);
    options.seed = static_cast<std::uint64_t>(seed);
    options.max_depth = 3;  // into the glass, out of it, onto the screen
    const Image picture = render(tracer, camera, options).image;
    Vec3d sum(0), moment(0);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Ray ray = camera.ray((x + 0.5) / width, (y + 0.5) / height, static_cast<double>(width) / height);
        const auto [place, area] = prism.on_screen(ray, forward);
        const Vec3d light = area * Vec3d(picture.rgb(x, y));
        sum += light;
        moment += place * light;
      }
    }
    mean += moment / sum / double{seeds};
    squares += moment / sum * (moment / sum) / double{seeds};
  }
  for (int k = 0; k < 3; ++k) {
    const double error = std::sqrt(std::max(0.0, squares[k] - mean[k] * mean[k]) / (seeds - 1));
    EXPECT_NEAR(mean[k], truth[k], 3 * error + 1e-5) << k;
    EXPECT_LT(error, 5e-4) << k;
  }
  EXPECT_GT(std::abs(truth.x - truth.z), 0.015) << "the spectrum is centimetres long";
}

// In a red box seen from a lamp's side: the same as by paths from the eye.
TEST(SpectralLight, ColouredWallsAsByPath) {
  const Scene scene = make_builtin_scene("cornell-box");
  const RayTracer tracer(scene);
  const auto mean_of = [&](RenderOptions options) {
    Vec3d mean(0), squares(0);
    constexpr int seeds = 20;
    for (int seed = 0; seed < seeds; ++seed) {
      options.seed = static_cast<std::uint64_t>(seed);
      const Image picture = render(tracer, scene.cameras[0], options).image;
      Vec3d sum(0);
      for (int y = 0; y < options.height; ++y) {
        for (int x = 0; x < options.width; ++x) sum += Vec3d(picture.rgb(x, y));
      }
      sum /= double(options.width) * options.height;
      mean += sum / double{seeds};
      squares += sum * sum / double{seeds};
    }
    Seen seen;
    seen.radiance = Rgb(mean);
    seen.errors = Rgb(glm::sqrt(glm::max(Vec3d(0), squares - mean * mean) / double{seeds - 1}));
    return seen;
  };
  RenderOptions by_path = spectral(path(64));
  by_path.width = by_path.height = 12;
  const Seen a = mean_of(particles(12, 12, 100)), b = mean_of(by_path);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(a.radiance[k], b.radiance[k], 3 * std::hypot(a.errors[k], b.errors[k]) + 1e-4) << k;
    EXPECT_LT(a.errors[k], 0.05 * max_component(b.radiance)) << k;
  }
}

TEST(SpectralLight, DyesAndLampsWithSpectraAreRefused) {
  const Scene scene = make_builtin_scene("fluorescent");
  const RayTracer tracer(scene);
  EXPECT_THROW((void)render(tracer, scene.cameras[0], particles(4, 4, 1)), std::invalid_argument);
}

TEST(SpectralLight, ThreadedPicturesAreTheSameBits) {
  const Scene scene = make_builtin_scene("prism?beam=1");
  const RayTracer tracer(scene);
  std::vector<std::vector<float>> pictures;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    pictures.push_back(render(tracer, scene.cameras[0], particles(40, 30, 16)).image.data);
  }
  EXPECT_EQ(pictures[0], pictures[1]);
  EXPECT_EQ(pictures[0], pictures[2]);
}

}  // namespace
}  // namespace penumbra
