// In a closed room where everything emits L and reflects rho alike, radiance is L / (1 - rho) everywhere, whatever the
// shape.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "penumbra/image/image.h"
#include "penumbra/render/render.h"
#include "penumbra/scene/builtin_scenes.h"

namespace penumbra {
namespace {

// Share of pixels further than 3 of their own standard errors from the truth, and the mean's distance in its own.
struct FurnaceVerdict {
  double mean_in_sigmas = 0;
  double pixels_outside = 0;
};

FurnaceVerdict judge(double rho, int samples) {
  const Scene scene = make_builtin_scene("furnace?rho=" + std::to_string(rho));
  const RayTracer tracer(scene);
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = 64;
  options.samples_per_pixel = samples;
  options.aovs = {Aov::variance};
  const Image image = render(tracer, scene.cameras.at(0), options).image;
  const double truth = 1 / (1 - rho);
  double sum = 0, variance = 0;
  int outside = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double value = image.pixel(x, y)[0];
      const double pixel_variance = image.pixel(x, y)[3];
      sum += value;
      variance += pixel_variance;
      outside += std::abs(value - truth) > 3 * std::sqrt(pixel_variance) ? 1 : 0;
    }
  }
  const double n = 64.0 * 64;
  return {std::abs(sum / n - truth) / (std::sqrt(variance) / n), outside / n};
}

TEST(Furnace, PathTracingFindsTheUniformRadiance) {
  for (const double rho : {0.0, 0.3, 0.5}) {
    const FurnaceVerdict v = judge(rho, 256);
    if (rho == 0) continue;  // no variance at all: the pictures below test its value
    EXPECT_LE(v.mean_in_sigmas, 3) << "rho " << rho;
    EXPECT_LE(v.pixels_outside, 0.01) << "rho " << rho;
  }
}

// The standard errors follow the samples; the address sanitizer makes them dear.
#ifdef __SANITIZE_ADDRESS__
constexpr int many_samples = 128;
#else
constexpr int many_samples = 1024;
#endif

TEST(FurnaceSlow, HoldsWhenLittleIsAbsorbed) {
  for (const double rho : {0.8, 0.9}) {
    const FurnaceVerdict v = judge(rho, many_samples);
    EXPECT_LE(v.mean_in_sigmas, 3) << "rho " << rho;
    EXPECT_LE(v.pixels_outside, 0.01) << "rho " << rho;
  }
}

}  // namespace
}  // namespace penumbra
