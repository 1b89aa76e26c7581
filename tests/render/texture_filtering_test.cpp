// Textures averaged over what samples cover, by ray differentials: the pictures of few samples against those of many.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/camera_rays.h"
#include "penumbra/render/render.h"
#include "penumbra/tracing/shading/specular_tree.h"
#include "render/probe.h"

namespace penumbra {
namespace {

using namespace testing;

constexpr int width = 36;
constexpr int height = 24;

Material checker() {
  Material m = matt(Rgb(0.9F));
  m.unlit = true;
  m.checker_colour = Rgb(0.1F);
  return m;
}

/// As bright under ambient light of radiance 1, but not unlit: what packets of rays shade.
Material matt_checker(Scene& scene) {
  scene.lights.push_back({"", AmbientLight{Rgb(1)}});
  Material m = checker();
  m.unlit = false;
  return m;
}

Rgb brightness(const SurfaceMaterial& surface) {
  return surface.emission + (1 - surface.transmission) * surface.base_colour;
}

/// Squares of eight texels that repeat; unlit.
Material checkered_texture(Scene& scene) {
  TextureImage image{"squares", 16, 16, 1, {}};
  std::vector<float> texels;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) texels.push_back((x < 8) == (y < 8) ? 0.9F : 0.1F);
  }
  image.texels = texels;
  scene.textures.push_back({.image = static_cast<std::uint32_t>(scene.images.size())});
  scene.images.push_back(image);
  Material m = matt(Rgb(1));
  m.unlit = true;
  m.base_colour_texture = TextureRef{.texture = static_cast<std::uint32_t>(scene.textures.size() - 1)};
  return m;
}

Camera low_camera() {
  return {.name = "low", .to_world = look_at({0.3, 1.5, 0}, {0.8, 1.05, -4}, {0, 1, 0}), .lens = PerspectiveLens{0.8}};
}

Image drawn(const RayTracer& tracer, const Camera& camera, IntegratorKind integrator, int samples,
            std::uint64_t seed = 0) {
  RenderOptions options;
  options.integrator = integrator;
  options.width = width;
  options.height = height;
  options.samples_per_pixel = samples;
  options.seed = seed;
  return render(tracer, camera, options).image;
}

/// The same picture with textures read at points: what `colour` says of each hit, or the sky's black.
Image read_at_points(const Camera& camera, int samples, const std::function<float(const Ray&)>& radiance) {
  Image image(width, height);
  const CameraRays rays(camera, width, height, FilterKind::box, samples);
  parallel_for(height, 1, [&](std::size_t first, std::size_t last) {
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0;
        for (int s = 0; s < samples; ++s) {
          PixelSampler sampler(1, x, y, s);
          sum += static_cast<double>(radiance(rays.ray(x, y, sampler).ray));
        }
        for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = static_cast<float>(sum / samples);
      }
    }
  });
  return image;
}

double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) sum += std::pow(static_cast<double>(a.pixel(x, y)[1] - b.pixel(x, y)[1]), 2);
  }
  return std::sqrt(sum / (width * height));
}

double mean(const Image& a) {
  double sum = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) sum += static_cast<double>(a.pixel(x, y)[1]);
  }
  return sum / (width * height);
}

struct Floor {
  Scene scene;
  std::function<float(const Ray&)> at_points;
};

// The floor alone, seen directly.
Floor seen_directly(const std::function<Material(Scene&)>& material) {
  Floor floor;
  floor.scene.environment = Environment{.radiance = Rgb(0), .image = std::nullopt};
  Mesh plane = rectangle({-400, 0, 400}, {800, 0, 0}, {0, 0, -800});
  plane.uv[0] = {{-200, 200}, {200, 200}, {200, -200}, {-200, -200}};
  add_mesh(floor.scene, plane, material(floor.scene));
  return floor;
}

float radiance_at_point(const RayTracer& tracer, const Ray& ray) {
  const auto hit = tracer.nearest(ray);
  if (!hit) return 0;
  return brightness(surface_material(tracer.scene(), tracer.surface_point(ray, *hit))).y;
}

void expect_filtered(const std::function<Material(Scene&)>& material, int samples_of_truth) {
  const Floor floor = seen_directly(material);
  const RayTracer tracer(floor.scene);
  const Camera camera = low_camera();
  const auto at_point = [&](const Ray& ray) { return radiance_at_point(tracer, ray); };
  const Image truth = read_at_points(camera, samples_of_truth, at_point);
  for (const int samples : {1, 4}) {
    const double unfiltered = rms(read_at_points(camera, samples, at_point), truth);
    for (const IntegratorKind kind : {IntegratorKind::appel, IntegratorKind::whitted, IntegratorKind::path}) {
      const bool sees_ambient = kind != IntegratorKind::path;
      if (!floor.scene.lights.empty() && !sees_ambient) continue;
      const double filtered = rms(drawn(tracer, camera, kind, samples), truth);
      EXPECT_LT(filtered, (samples == 1 ? 0.35 : 0.6) * unfiltered) << samples << " " << static_cast<int>(kind);
    }
  }
}

TEST(TextureFiltering, ACheckerOfFewSamplesIsNearThatOfMany) {
  expect_filtered([](Scene&) { return checker(); }, 144);
}

TEST(TextureFiltering, AMattCheckerInPacketsToo) { expect_filtered(matt_checker, 144); }

TEST(TextureFiltering, ATextureOfFewSamplesIsNearThatOfMany) { expect_filtered(checkered_texture, 144); }

// What is averaged over less and less is read at points in the end: pictures of many samples agree.
TEST(TextureFiltering, LeavesNoBiasInManySamplesSlow) {
  for (const auto& material :
       std::vector<std::function<Material(Scene&)>>{[](Scene&) { return checker(); }, checkered_texture}) {
    const Floor floor = seen_directly(material);
    const RayTracer tracer(floor.scene);
    const Camera camera = low_camera();
    const Image truth = read_at_points(camera, 4096, [&](const Ray& ray) { return radiance_at_point(tracer, ray); });
    const Image filtered = drawn(tracer, camera, IntegratorKind::whitted, 4096, 5);
    EXPECT_LT(rms(filtered, truth), 2e-3);
    EXPECT_NEAR(mean(filtered), mean(truth), 2e-4);
  }
}

/// The floor by way of one mirror ball, or through a pane and a ball of glass.
void expect_filtered_beyond(const std::function<Material(Scene&)>& floor_material, const Shape& shape,
                            const Material& material) {
  Floor floor = seen_directly(floor_material);
  add_shape(floor.scene, shape, material);
  const RayTracer tracer(floor.scene);
  const Camera camera = {
      .name = "", .to_world = look_at({0, 2.2, 4}, {0, 1.2, 0}, {0, 1, 0}), .lens = PerspectiveLens{0.6}};
  // Without its differential a ray reads at points.
  const auto at_points = [&](int samples) {
    const SpecularTree tree(tracer, false);
    class Eye final : public SpecularTree::Visitor {
     public:
      Rgb surface(const SpecularTree::Node& node) override { return brightness(node.surface); }
      Rgb sky(const Ray&, const SpecularTree::Branch&) override { return Rgb(0); }
      float followed(const Rgb& weight, int depth) override {
        return depth < 16 && max_component(weight) >= 1e-3F ? 1 : 0;
      }
      void count(bool, int) override {}
    };
    return read_at_points(camera, samples, [&](const Ray& ray) {
      Eye eye;
      return tree.trace(ray, {.start = ray.origin}, eye).y;
    });
  };
  const Image truth = at_points(144);
  const double unfiltered = rms(at_points(1), truth);
  const double filtered = rms(drawn(tracer, camera, IntegratorKind::whitted, 1), truth);
  EXPECT_LT(filtered, 0.5 * unfiltered);
}

constexpr Sphere ball{{0, 1.2, 0}, 1};

TEST(TextureFiltering, ReachesThroughReflection) {
  expect_filtered_beyond([](Scene&) { return checker(); }, ball, mirror(Rgb(0.9F)));
  expect_filtered_beyond(matt_checker, ball, mirror(Rgb(0.9F)));
}

TEST(TextureFiltering, ReachesThroughRefraction) {
  Material clear = glass(1.5F);
  expect_filtered_beyond([](Scene&) { return checker(); }, ball, clear);
  expect_filtered_beyond(matt_checker, ball, clear);
}

}  // namespace
}  // namespace penumbra
